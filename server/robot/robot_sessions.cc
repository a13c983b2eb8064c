#include "server/robot/robot_sessions.h"

#include <algorithm>
#include <utility>

#include "server/robot/limits.h"
#include "server/robot/mutation.h"
#include "server/robot/outcome.h"
#include "storage/bounds.h"
#include "storage/open_stream.h"
#include "storage/rejects.h"

namespace uplink::robot {

static_assert(kSessionsMax == storage::kSessionsPerRobotMax, "memory and the store keep as many");

std::optional<Reconnects::Arrival> RobotSessions::Arrive(SteadyTime now,
                                                         const ReconnectLimits& limits) {
  const std::lock_guard lock(mutex_);
  return reconnects_.Arrive(now, limits);
}

RobotSessions::Attached RobotSessions::Attach(loop::StreamRef stream, SteadyTime now,
                                              SystemTime system_now, Newcomer comer) {
  const std::lock_guard lock(mutex_);
  if (comer.number && !reconnects_.MayAttach(*comer.number)) return {Standing::kSuperseded};
  return takeover_.Attach(stream, now, system_now, std::move(comer.gateway));
}

loop::StreamRef RobotSessions::Detach(loop::StreamRef stream, SteadyTime now) {
  const std::lock_guard lock(mutex_);
  if (stream == takeover_.current() && current_session_) {
    if (SessionMemory* memory = sessions_.Find(*current_session_)) {
      memory->last_used = now;
      memory->released.clear();
    }
  }
  return takeover_.Detach(stream);
}

std::optional<RobotSessions::Begun> RobotSessions::Begin(const model::SessionId& session,
                                                         SteadyTime now, const FleetClaim& claim) {
  const std::lock_guard lock(mutex_);
  const FleetClaims::Effect effect = fleet_claims_.Add(claim, takeover_.current());
  std::optional<std::size_t> disowned;
  if (effect.disowns) disowned = Void();
  SessionMemory* memory = sessions_.FindOrCreate(session);
  if (memory == nullptr) return std::nullopt;
  memory->last_used = now;
  current_session_ = session;
  // ResumeFrom counts: until then no message is processed.
  unconfirmed_.store(0);
  free_through_.store(kNotKnown);
  last_session_.reset();
  resends_.Begin();
  return Begun{.open_id = open_answer_.Ask(),
               .generation = generation_.load(),
               .fleet_word = effect.word,
               .disowned = disowned};
}

Resume RobotSessions::ResumeFrom(const model::SessionId& session, std::uint64_t open_id,
                                 model::Seq settled_seq, model::Seq judged_seq) {
  const std::lock_guard lock(mutex_);
  SessionMemory* memory = sessions_.Find(session);
  if (memory == nullptr) return {.committed = settled_seq, .rejects = {}};
  Resume resume = ResumeOf(*memory, open_answer_, {open_id, settled_seq, judged_seq});
  CountUnconfirmed();
  return resume;
}

void RobotSessions::CountUnconfirmed() {
  const SessionMemory* memory = CurrentSession();
  has_unread_.store(memory != nullptr && memory->rejects.has_unread());
  unconfirmed_.store(memory == nullptr ? 0 : memory->rejects.unconfirmed());
}

Seen RobotSessions::See(const model::SessionId& session, model::Seq seq) {
  const std::lock_guard lock(mutex_);
  SessionMemory* memory = sessions_.Find(session);
  if (memory == nullptr) return {.as = SeenAs::kVoid};
  return memory->numbers.See(seq);
}

void RobotSessions::AddSettled(const model::SessionId& session, model::Seq seq) {
  const std::lock_guard lock(mutex_);
  if (SessionMemory* memory = sessions_.Find(session)) memory->numbers.AddSettled(seq);
}

std::int64_t RobotSessions::AddWaiting(const model::SessionId& session, model::Seq seq,
                                       std::size_t bytes) {
  const std::lock_guard lock(mutex_);
  SessionMemory* memory = sessions_.Find(session);
  if (memory == nullptr) return 0;
  const std::size_t grew = memory->numbers.AddWaiting(seq);
  in_flight_.fetch_add(grew);
  if (grew > 0) record_bytes_.fetch_add(bytes);
  return static_cast<std::int64_t>(grew);
}

void RobotSessions::Remember(const model::SessionId& session, RejectedSeq rejected) {
  const std::lock_guard lock(mutex_);
  if (SessionMemory* memory = sessions_.Find(session)) {
    memory->rejects.Remember(std::move(rejected));
    CountUnconfirmed();
  }
}

Progress RobotSessions::Take(const model::SessionId& session) {
  const std::lock_guard lock(mutex_);
  SessionMemory* memory = sessions_.Find(session);
  return memory == nullptr ? Progress() : TakeProgress(*memory);
}

std::optional<UnreadRejects> RobotSessions::UnreadOf(const model::SessionId& session) const {
  if (!has_unread_.load()) return std::nullopt;
  const std::lock_guard lock(mutex_);
  const SessionMemory* memory = sessions_.Find(session);
  return memory == nullptr ? std::nullopt : memory->rejects.unread(memory->numbers.through());
}

void RobotSessions::AddPage(const model::SessionId& session,
                            std::vector<storage::StoredReject> page, model::Seq through) {
  const std::lock_guard lock(mutex_);
  SessionMemory* memory = sessions_.Find(session);
  if (memory == nullptr) return;
  memory->rejects.AddPage(RejectedOf(std::move(page)), through);
  CountUnconfirmed();
}

bool RobotSessions::AwaitsRejects(const model::SessionId& session) const {
  const std::lock_guard lock(mutex_);
  const SessionMemory* memory = sessions_.Find(session);
  return memory != nullptr && memory->rejects.told_through().has_value();
}

std::size_t RobotSessions::waiting(const model::SessionId& session) const {
  const std::lock_guard lock(mutex_);
  const SessionMemory* memory = sessions_.Find(session);
  return memory == nullptr ? 0 : memory->numbers.waiting();
}

SessionView RobotSessions::View() const {
  const std::lock_guard lock(mutex_);
  SessionView view = ViewOf(takeover_, held_back_);
  if (const SessionMemory* memory = CurrentSession()) {
    view.session = current_session_;
    view.settled_seq = memory->numbers.through();
    view.missing = memory->numbers.missing();
  } else if (last_session_) {
    view.session = last_session_->session;
    view.settled_seq = last_session_->settled_seq;
  }
  return view;
}

const SessionMemory* RobotSessions::CurrentSession() const {
  return current_session_ ? sessions_.Find(*current_session_) : nullptr;
}

void RobotSessions::Restore(const storage::SettledSession& last) {
  const std::lock_guard lock(mutex_);
  if (CurrentSession() != nullptr) return;
  const model::Seq known =
      last_session_ && last_session_->session == last.session ? last_session_->settled_seq : 0;
  last_session_ = {last.session, std::max(known, last.settled_seq)};
}

std::optional<storage::SettledSession> RobotSessions::TakeSettled() {
  const std::lock_guard lock(mutex_);
  const auto now = SettledOf(CurrentSession(), current_session_);
  if (!now || settled_taken_ == now) return std::nullopt;
  return settled_taken_ = now;
}

void RobotSessions::PutBackSettled() {
  const std::lock_guard lock(mutex_);
  settled_taken_.reset();
}

void RobotSessions::Sweep(SteadyTime now, milliseconds idle) {
  const std::lock_guard lock(mutex_);
  const auto last = SettledOf(CurrentSession(), current_session_);
  sessions_.ForgetIdle(now, idle, takeover_.current() ? current_session_ : std::nullopt);
  if (last && CurrentSession() == nullptr) last_session_ = last;
  takeover_.Sweep(now);
}

bool RobotSessions::HasStream() const {
  const std::lock_guard lock(mutex_);
  return static_cast<bool>(takeover_.current());
}

loop::StreamRef RobotSessions::OnOpened(std::uint64_t open_id, const storage::OpenResult& result) {
  const std::lock_guard lock(mutex_);
  if (open_answer_.Answer(open_id, result)) {
    fleet_claims_.Answered();
    free_through_.store(result.cursor);
    if (SessionMemory* memory = sessions_.Find(*current_session_)) {
      memory->committed = std::max(memory->committed, result.cursor);
    }
    // Numbers at or below the cursor are no news to the store, even if they wait.
    resends_.Answer(result.latest_kinds, [&](const SentMessage& sent) {
      const SessionMemory* memory = sessions_.Find(sent.session);
      const bool known = sent.session == current_session_ && sent.seq <= result.cursor;
      return memory != nullptr && memory->numbers.Waits(sent.seq) && !known;
    });
  }
  if (open_answer_.came_late()) {
    StoredSession stored = StoredOf(open_answer_.Take(open_id));
    if (SessionMemory* memory = sessions_.Find(*current_session_)) {
      memory->rejects.AddLate(std::move(stored.rejects));
      memory->rejects.BeginPages(stored.unread, stored.more);
      CountUnconfirmed();
    }
  }
  return takeover_.current();
}

loop::StreamRef RobotSessions::OnSettled(std::span<const Settled> settled,
                                         metrics::Ledger& ledger) {
  metrics::MessageCounts counts;
  loop::StreamRef wake;
  {
    const std::lock_guard lock(mutex_);
    wake = takeover_.current();
    for (const Settled& one : settled) {
      SessionMemory* memory = sessions_.Find(one.session);
      if (memory == nullptr) continue;
      const std::size_t shrank = memory->numbers.Settle(one.first.value_or(one.seq), one.seq);
      if (shrank == 0) continue;
      in_flight_.fetch_sub(shrank);
      record_bytes_.fetch_sub(one.bytes);
      counts.in_flight -= static_cast<std::int64_t>(shrank);
      memory->committed = std::max(memory->committed, one.seq);
      if (!Planted(Mutation::kSettleLost)) ApplyOutcome(one, shrank, memory->rejects, counts);
      if (wake && current_session_ == one.session) memory->released.push_back(one.arrived);
    }
    if (counts.rejected > 0) CountUnconfirmed();
  }
  Publish(counts, ledger);
  return wake;
}

loop::StreamRef RobotSessions::OnGapsWritten(std::size_t count) {
  gaps_in_flight_.fetch_sub(count);
  const std::lock_guard lock(mutex_);
  return takeover_.current();
}

loop::StreamRef RobotSessions::VoidAndStop(Standing standing, metrics::Ledger& ledger) {
  std::size_t waited = 0;
  loop::StreamRef wake;
  {
    const std::lock_guard lock(mutex_);
    waited = Void();
    fleet_claims_.Answered();
    takeover_.Stop(standing);
    wake = takeover_.current();
  }
  Publish(SupersededCounts(waited), ledger);
  return wake;
}

std::optional<FleetClaims::Refused> RobotSessions::OnOtherFleet(std::uint64_t open_id,
                                                                metrics::Ledger& ledger) {
  std::size_t waited = 0;
  std::optional<FleetClaims::Refused> refused;
  {
    const std::lock_guard lock(mutex_);
    if (open_answer_.IsLast(open_id)) refused = fleet_claims_.Refuse();
    if (!refused) return refused;
    waited = Void();
    takeover_.Refuse(refused->stream);
  }
  Publish(SupersededCounts(waited), ledger);
  return refused;
}

std::size_t RobotSessions::Void() {
  const std::size_t waiting = sessions_.waiting();
  in_flight_.fetch_sub(waiting);
  record_bytes_.store(0);
  sessions_.Clear();
  last_session_.reset();
  settled_taken_.reset();
  open_answer_.Forget();
  resends_.Begin();
  generation_.fetch_add(1);
  return waiting;
}

}  // namespace uplink::robot
