#include "server/robot/robot_state.h"

#include <utility>

namespace uplink::robot {

void RobotState::CountIn(std::shared_ptr<LiveTotal> total) {
  const std::lock_guard lock(mutex_);
  live_total_ = total;
  live_.CountIn(std::move(total));
}

void RobotState::Apply(std::vector<model::Record>& records, SteadyTime arrived) {
  {
    const std::lock_guard lock(mutex_);
    if (foreign_) return;
    for (model::Record& record : records) {
      if (record.variant() == model::Variant::kStatusTelemetry) status_arrived_ = arrived;
      keys_evicted_ += live_.Put(std::move(record).TakeBody(), arrived);
    }
  }
  if (live_total_ != nullptr) live_total_->Check();
}

void RobotState::Apply(model::RcanState&& state, SteadyTime arrived) {
  {
    const std::lock_guard lock(mutex_);
    if (foreign_) return;
    live_.Put(std::move(state));
    rcan_arrived_ = arrived;
  }
  if (live_total_ != nullptr) live_total_->Check();
}

std::size_t RobotState::live_bytes() const {
  const std::lock_guard lock(mutex_);
  return live_.bytes();
}

LivePartBytes RobotState::live_part_bytes() const {
  const std::lock_guard lock(mutex_);
  return live_.part_bytes();
}

std::size_t RobotState::DropLivePart(storage::LivePart part) {
  const std::lock_guard lock(mutex_);
  const std::size_t before = live_.bytes();
  live_.Drop(part);
  if (part == storage::LivePart::kStatus) status_arrived_ = {};
  if (part == storage::LivePart::kRcan) rcan_arrived_ = {};
  return before - live_.bytes();
}

void RobotState::KeepReport(const model::Body& report, SystemTime received_at) {
  if (!Reports::Follows(report)) return;
  const std::lock_guard lock(mutex_);
  if (foreign_) return;
  reports_.Add(report, received_at);
}

void RobotState::Restore(Reported before, storage::Epoch held_since) {
  const std::lock_guard lock(mutex_);
  if (foreign_ || held_since != held_since_) return;
  reports_.Restore(std::move(before));
}

void RobotState::SignOfLife(SteadyTime steady, SystemTime system, const PresenceLimits& limits) {
  const std::lock_guard lock(mutex_);
  if (presence_.AddSign(steady, system, limits) == PresenceTrack::Sign::kLatest) {
    signs_changed_ = true;
  }
}

void RobotState::BeginListening(SteadyTime now) {
  const std::lock_guard lock(mutex_);
  presence_.BeginListening(now);
}

void RobotState::SetReading(Reading reading, SteadyTime now) {
  const std::lock_guard lock(mutex_);
  presence_.SetReading(reading, now);
}

void RobotState::NoteStall(SteadyTime until) {
  const std::lock_guard lock(mutex_);
  presence_.AddStall(until);
}

void RobotState::NoteReplaced(const PresenceTrack::Replaced& replaced) {
  const std::lock_guard lock(mutex_);
  presence_.NoteReplaced(replaced);
}

bool RobotState::AskBeforeOffline(SteadyTime now, const PresenceLimits& limits) {
  const std::lock_guard lock(mutex_);
  const bool ask = presence_.AskBeforeOffline(now, limits);
  if (ask) ask_peer_.store(true);
  return ask;
}

void RobotState::NotePeerAnswered(SteadyTime now, const PresenceLimits& limits) {
  const std::lock_guard lock(mutex_);
  presence_.NotePeerAnswered(now, limits);
}

void RobotState::ForgetSigns(SteadyTime unknown_until, SystemTime system_now) {
  const std::lock_guard lock(mutex_);
  presence_.ForgetSigns(unknown_until, system_now);
}

void RobotState::NoteBatch(const BatchHead& head, SteadyTime now, SystemTime system_now) {
  const std::optional<Backlog> backlog = BacklogOf(head, system_now);
  if (head.sent_unix_ms <= 0 && !backlog) return;
  const std::lock_guard lock(mutex_);
  if (foreign_) return;
  if (backlog) backlog_ = backlog;
  if (head.sent_unix_ms <= 0) return;
  if (clock_skew_.Add(head.sent_unix_ms, system_now, now)) signs_changed_ = true;
}

void RobotState::BeginStream() {
  const std::lock_guard lock(mutex_);
  fields_dropped_ = 0;
  backlog_.reset();
  clock_skew_.BeginWindow();
}

void RobotState::Claim(SteadyTime now) {
  const std::lock_guard lock(mutex_);
  claimed_ = true;
  presence_.BeginStream(now);
  if (claim_ended_unheld_) Forget();
  if (!foreign_) return;
  foreign_.reset();
  presence_.Claim(presence_.now(), now);
}

void RobotState::BeginHold(const HoldNews& news, SteadyTime now, SystemTime system_now) {
  const std::lock_guard lock(mutex_);
  foreign_.reset();
  claim_ended_unheld_ = false;
  held_since_ = news.since;
  needs_restore_ = news.was_known;
  // If the store has no presence of a robot, it was never reported as anything but unknown.
  const storage::StoredPresence stored =
      news.presence.value_or(storage::StoredPresence{Presence::kUnknown, presence_.since()});
  switch (news.how) {
    case HoldBegan::kOpened:
      presence_.Claim(stored, now);
      return;
    case HoldBegan::kAdopted:
      if (connections_ == 0) last_end_ = EndOfHolder(stored.presence);
      presence_.Adopt({.stored = stored,
                       .end = news.end,
                       .unknown_until = now + news.grace,
                       .now = now,
                       .system_now = system_now});
      return;
  }
}

void RobotState::EndClaim() {
  const std::lock_guard lock(mutex_);
  claim_ended_unheld_ = claimed_ && held_since_ == 0;
  claimed_ = false;
}

void RobotState::Forget() {
  live_.Clear();
  reports_ = {};
  status_arrived_ = rcan_arrived_ = SteadyTime();
  signs_changed_ = false;
  clock_skew_ = {};
  backlog_.reset();
  claim_ended_unheld_ = false;
}

void RobotState::Lose() {
  const std::lock_guard lock(mutex_);
  Forget();
  held_since_ = 0;
  claimed_ = false;
  needs_restore_ = false;
  foreign_ = Foreign();
  presence_.Follow(presence_.now());
}

void RobotState::FollowHolder(Foreign foreign, const storage::StoredPresence& presence) {
  const std::lock_guard lock(mutex_);
  if (held_since_ != 0 || claimed_) return;
  if (!foreign_) Forget();
  foreign_ = std::move(foreign);
  presence_.Follow(presence);
}

storage::Epoch RobotState::held_since() const {
  const std::lock_guard lock(mutex_);
  return held_since_;
}

bool RobotState::needs_restore() const {
  const std::lock_guard lock(mutex_);
  return needs_restore_;
}

void RobotState::SetRestored(storage::Epoch held_since) {
  const std::lock_guard lock(mutex_);
  if (held_since != held_since_) return;
  needs_restore_ = false;
  live_.EndRestore();
}

void RobotState::CountDropped(std::size_t fields) {
  const std::lock_guard lock(mutex_);
  fields_dropped_ += static_cast<std::int64_t>(fields);
}

std::optional<LiveChanges> RobotState::TakeChanges() {
  const std::lock_guard lock(mutex_);
  if (foreign_ || needs_restore_) return std::nullopt;
  if (!live_.changed() && !signs_changed_) return std::nullopt;
  LiveChanges changes;
  changes.changed = live_.TakeChanged();
  signs_changed_ = false;
  changes.last_sign_of_life = presence_.last_sign();
  changes.clock_skew_ms = clock_skew_.estimate_ms();
  ForEachPart(
      [&changes]<typename Tag>(Tag /*row*/, const auto& from, auto& to) {
        if (changes.changed.test(Tag::kIndex)) to = from;
      },
      live_.parts(), changes.parts);
  return changes;
}

void RobotState::PutBackChanges(const LivePartSet& changed) {
  const std::lock_guard lock(mutex_);
  if (foreign_) return;
  live_.PutBackChanged(changed);
  signs_changed_ = true;
}

void RobotState::Restore(LiveBefore before, storage::Epoch held_since) {
  const std::lock_guard lock(mutex_);
  if (foreign_ || held_since != held_since_) return;
  live_.Restore(std::move(before.parts));
  presence_.Restore(before.last_sign_of_life);
  clock_skew_.Restore(before.clock_skew_ms);
}

std::optional<Presence> RobotState::Sweep(SteadyTime steady, SystemTime system,
                                          const PresenceLimits& limits) {
  const std::lock_guard lock(mutex_);
  presence_.SweepAround(steady, system, limits);
  if (foreign_) return std::nullopt;
  return presence_.Sweep(steady, system, limits);
}

Presence RobotState::presence() const {
  const std::lock_guard lock(mutex_);
  return presence_.presence();
}

SystemTime RobotState::presence_since() const {
  const std::lock_guard lock(mutex_);
  return presence_.since();
}

StateSnapshot RobotState::Snapshot(Parts parts) const {
  const std::lock_guard lock(mutex_);
  StateSnapshot snapshot{.parts = {},
                         .live_changes = live_.changes(),
                         .presence = presence_.presence(),
                         .presence_since = presence_.since(),
                         .last_sign_of_life = presence_.last_sign(),
                         .parked_until = presence_.parked_until(),
                         .flapping = presence_.flapping(),
                         .clock_skew_ms = clock_skew_.estimate_ms(),
                         .backlog = backlog_,
                         .fields_dropped = fields_dropped_,
                         .keys_evicted = keys_evicted_,
                         .last_end = last_end_,
                         .foreign = foreign_};
  switch (parts) {
    case Parts::kNone:
      break;
    case Parts::kSmall:
      ForEachPart(
          []<typename Tag>(Tag /*row*/, const auto& from, auto& to) {
            if constexpr (Tag::kSmall) to = from;
          },
          live_.parts(), snapshot.parts);
      break;
    case Parts::kAll:
      snapshot.parts = live_.parts();
      break;
  }
  return snapshot;
}

}  // namespace uplink::robot
