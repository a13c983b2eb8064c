#include "server/journal/turns.h"

#include <algorithm>
#include <utility>

namespace uplink::journal {

Turns::Turns(const WriterContext& context, const JournalLimits& limits,
             const storage::ProcessId& process)
    : clock_(context.clock),
      inbox_(context.inbox),
      holds_(context),
      comparing_(context, holds_),
      opening_(context, holds_),
      adopting_(context, holds_),
      claiming_(context, holds_),
      committing_(context, holds_,
                  {.records_max = limits.batch_records_max,
                   .bytes_max = limits.batch_bytes_max,
                   .robot = limits.batch_robot,
                   .gateway = limits.batch_gateway},
                  model::SessionId(process)),
      expiry_sweep_(context,
                    limits.sweeps ? context.clock.Steady() + kSweepInterval : Duty::kNever),
      // At once: a store may need room for today.
      retention_(context, limits.retains ? context.clock.Steady() : Duty::kNever),
      quarantine_trim_(context),
      connection_ends_(context),
      checkpoints_(context, holds_) {}

void Turns::WaitForWork(const std::stop_token& stop) {
  const SteadyTime due = std::min({clock_.Steady() + kSweepInterval, expiry_sweep_.duty().due(),
                                   retention_.duty().due(), quarantine_trim_.due(),
                                   connection_ends_.duty().due(), checkpoints_.duty().due()});
  inbox_.WaitUntil(due, stop);
}

Step Turns::Advance() {
  if (committing_.HasOutcomes()) {
    committing_.Tell();
    return Step::kWorked;
  }
  if (comparing_.Due()) {
    // It is gathered anew afterwards, since some of its entries may be void by then.
    committing_.PutBack();
    claiming_.DoubtAll();
    if (const std::optional<Step> failed = comparing_.Do()) return *failed;
  }
  // Waiting work goes between two duties, so that a robot waits for one long duty at most; and
  // before a checkpoint, which takes many calls.
  const bool after_duty = std::exchange(after_duty_, false);
  std::optional<Step> done;
  if (!after_duty) done = AdvanceDuty();
  if (!done && std::exchange(after_work_, false)) done = checkpoints_.Advance();
  if (!done) done = AdvanceWork();
  if (!done) done = checkpoints_.Advance();
  if (!done && after_duty) done = AdvanceDuty();
  return done.value_or(Step::kIdle);
}

std::optional<Step> Turns::AdvanceWork() {
  after_work_ = true;
  // In turn, so that a storm of streams delays no commit, and no commit a Welcome.
  const bool batch_turn = std::exchange(batch_turn_, false);
  if (!batch_turn && GatherOpens()) return opening_.Open();
  if (!batch_turn) {
    if (const std::optional<Step> done = AdvanceHands()) {
      batch_turn_ = true;
      return done;
    }
  }
  if (committing_.Gather()) return committing_.Commit();
  if (batch_turn && GatherOpens()) return opening_.Open();
  if (batch_turn) {
    if (const std::optional<Step> done = AdvanceHands()) return done;
  }
  after_work_ = false;
  return std::nullopt;
}

std::optional<Step> Turns::AdvanceHands() {
  if (const std::optional<Step> adopted = adopting_.Advance()) return adopted;
  return claiming_.Advance();
}

bool Turns::GatherOpens() {
  const Opening::Gathered gathered = opening_.Gather();
  batch_turn_ = gathered.opens && (gathered.records_wait || committing_.HasBatch());
  return gathered.opens;
}

std::optional<Step> Turns::AdvanceDuty() {
  const SteadyTime now = clock_.Steady();
  after_duty_ = true;
  if (expiry_sweep_.duty().IsDue(now)) return expiry_sweep_.Do();
  if (retention_.duty().IsDue(now)) return retention_.Do();
  if (now >= quarantine_trim_.due()) return quarantine_trim_.Do();
  if (connection_ends_.duty().IsDue(now)) return connection_ends_.Do();
  after_duty_ = false;
  return std::nullopt;
}

}  // namespace uplink::journal
