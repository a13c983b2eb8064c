#include "server/journal/journal.h"

#include <algorithm>
#include <utility>

#include "server/journal/checkpoint_rounds.h"
#include "server/journal/committing.h"
#include "server/journal/expiry_sweep.h"
#include "server/journal/held_robots.h"
#include "server/journal/opening.h"
#include "server/journal/retention.h"
#include "server/journal/writer_context.h"

namespace uplink::journal {

/// What the writer's thread alone uses, without a lock. Other threads read only the errors of its
/// duties, which have locks of their own, and whether checkpoints have a source, which is fixed
/// before the writer starts.
struct Journal::WriterState {
  WriterState(const WriterContext& context, const JournalLimits& limits,
              const storage::ProcessId& process)
      : opening(context, held),
        committing(context, held,
                   {.records_max = limits.batch_records_max, .bytes_max = limits.batch_bytes_max},
                   model::SessionId(process)),
        expiry_sweep(context,
                     limits.sweeps ? context.clock.Steady() + kSweepInterval : Duty::kNever),
        // At once: a store may need room for today.
        retention(context, limits.retains ? context.clock.Steady() : Duty::kNever),
        checkpoints(context) {}

  HeldRobots held;
  Opening opening;
  Committing committing;
  ExpirySweep expiry_sweep;
  Retention retention;
  CheckpointRounds checkpoints;
  /// The last call opened streams while records waited: they are next.
  bool batch_turn = false;
  /// The last call was a duty's: what waits is next.
  bool after_duty = false;
  /// The last call was for what waits: a checkpoint that is due is next.
  bool after_work = false;
};

Journal::Journal(storage::Store& store, const JournalLimits& limits, const Clock& clock,
                 metrics::Ledger& ledger, JournalProbe& probe, const storage::ProcessId& process)
    : clock_(clock),
      inbox_(limits, clock),
      errors_(probe),
      state_(std::make_unique<WriterState>(WriterContext{.store = store,
                                                         .clock = clock,
                                                         .ledger = ledger,
                                                         .probe = probe,
                                                         .inbox = inbox_,
                                                         .errors = errors_},
                                           limits, process)) {}

Journal::~Journal() = default;

void Journal::Open(robot::CommitClient& client, std::uint64_t open_id,
                   storage::OpenRequest request) {
  inbox_.Open({.client = &client, .open_id = open_id, .request = std::move(request)});
}

void Journal::Append(robot::CommitClient& client, std::uint64_t generation,
                     storage::CommitRecord record, SteadyTime arrived) {
  inbox_.Append(client, generation, std::move(record), arrived);
}

void Journal::AppendGap(robot::CommitClient& client, std::uint64_t generation,
                        storage::GapItem gap) {
  inbox_.AppendGap(client, generation, std::move(gap));
}

void Journal::NotePresence(const storage::RobotRef& robot, model::Presence presence,
                           SystemTime at) {
  inbox_.NotePresence(robot, presence, at);
}

void Journal::BeginPresence(const storage::RobotRef& robot, model::Presence stored,
                            SystemTime now) {
  inbox_.BeginPresence(robot, stored, now);
}

void Journal::CheckpointFrom(fleet::LiveSource& live, milliseconds every) {
  state_->checkpoints.SetSource(live, every);
}

void Journal::RequestCheckpoint() {
  if (state_->checkpoints.HasSource()) inbox_.RequestCheckpoint();
}

absl::Status Journal::retain_error() const { return state_->retention.duty().error(); }

absl::Status Journal::checkpoint_error() const { return state_->checkpoints.duty().error(); }

void Journal::WaitForWork(const std::stop_token& stop) {
  const SteadyTime due =
      std::min({clock_.Steady() + kSweepInterval, state_->expiry_sweep.duty().due(),
                state_->retention.duty().due(), state_->checkpoints.duty().due()});
  inbox_.WaitUntil(due, stop);
}

Journal::Step Journal::Advance() {
  if (state_->committing.HasOutcomes()) {
    state_->committing.Tell();
    return Step::kWorked;
  }
  // What waits goes between two duties, so that a long one that is followed by the next keeps no
  // robot waiting for more than itself; and before a checkpoint, of which there are many calls.
  const bool after_duty = std::exchange(state_->after_duty, false);
  std::optional<Step> done;
  if (!after_duty) done = AdvanceDuty();
  if (!done && std::exchange(state_->after_work, false)) done = state_->checkpoints.Advance();
  if (!done) done = AdvanceWork();
  if (!done) done = state_->checkpoints.Advance();
  if (!done && after_duty) done = AdvanceDuty();
  return done.value_or(Step::kIdle);
}

std::optional<Journal::Step> Journal::AdvanceWork() {
  state_->after_work = true;
  // Alternately, so that a storm of streams keeps no commit waiting, and no commit a Welcome.
  const bool batch_turn = std::exchange(state_->batch_turn, false);
  if (!batch_turn && GatherOpens()) return state_->opening.Open();
  if (state_->committing.Gather()) return state_->committing.Commit();
  if (batch_turn && GatherOpens()) return state_->opening.Open();
  state_->after_work = false;
  return std::nullopt;
}

bool Journal::GatherOpens() {
  const Opening::Gathered gathered = state_->opening.Gather();
  state_->batch_turn = gathered.opens && (gathered.records_wait || state_->committing.HasBatch());
  return gathered.opens;
}

std::optional<Journal::Step> Journal::AdvanceDuty() {
  const SteadyTime now = clock_.Steady();
  state_->after_duty = true;
  if (state_->expiry_sweep.duty().IsDue(now)) return state_->expiry_sweep.Do();
  if (state_->retention.duty().IsDue(now)) return state_->retention.Do();
  state_->after_duty = false;
  return std::nullopt;
}

}  // namespace uplink::journal
