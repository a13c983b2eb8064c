#include "server/robot/robot_state.h"

#include <utility>

#include "schema/base/check.h"

namespace uplink::robot {
namespace {

/// Takes over the part of an earlier life as far as it is not known better by now. True if the
/// store then has neither side whole.
template <typename Message>
bool Merge(std::optional<Message>& part, std::optional<Message>&& before) {
  if (!part) part = std::move(before);
  return false;
}

template <typename Value, std::size_t kMax>
bool Merge(LatestByKey<Value, kMax>& part, LatestByKey<Value, kMax>&& before) {
  const bool both = !part.items().empty() && !before.items().empty();
  part.PutOnTopOf(std::move(before));
  return both;
}

}  // namespace

void RobotState::Apply(std::vector<model::Record>& records, SteadyTime arrived) {
  const std::lock_guard lock(mutex_);
  for (model::Record& record : records) {
    if (record.variant() == model::Variant::kStatusTelemetry) status_arrived_ = arrived;
    const std::optional<storage::LivePart> part = PartOfVariant(record.variant());
    UPLINK_CHECK(part.has_value(), "only live kinds are applied");
    parts_changed_.set(static_cast<std::size_t>(*part));
    keys_evicted_ += PutInto(parts_, std::move(record).TakeBody(), arrived);
  }
}

void RobotState::Apply(model::RcanState&& state, SteadyTime arrived) {
  const std::lock_guard lock(mutex_);
  parts_changed_.set(static_cast<std::size_t>(storage::LivePart::kRcan));
  parts_.rcan = std::move(state);
  rcan_arrived_ = arrived;
}

void RobotState::Note(const model::Body& report, SystemTime received_at) {
  if (const auto* info = std::get_if<model::AgentInfo>(&report)) {
    if (!info->uptime_s || *info->uptime_s > kUptimeSMax) return;
    const std::lock_guard lock(mutex_);
    reported_.booted_at =
        received_at - std::chrono::seconds(static_cast<std::int64_t>(*info->uptime_s));
  } else if (const auto* run = std::get_if<model::MissionRunStatus>(&report)) {
    std::string key = RunKey(run->mission_id, run->run_id);
    const std::lock_guard lock(mutex_);
    if (model::IsTerminal(run->status)) {
      reported_.open_runs.Erase(key);
      ended_runs_.Put(std::move(key), true);
      return;
    }
    ended_runs_.Erase(key);
    std::optional<double> progress;
    if (run->progress_x100) progress = *run->progress_x100 / kProgressAPercent;
    reported_.open_runs.Put(std::move(key), progress);
  }
}

void RobotState::Restore(Reported before) {
  const std::lock_guard lock(mutex_);
  if (!reported_.booted_at) reported_.booted_at = before.booted_at;
  for (const auto& [key, ended] : ended_runs_.items()) before.open_runs.Erase(key);
  reported_.open_runs.PutOnTopOf(std::move(before.open_runs));
}

void RobotState::Reach(SteadyTime steady, SystemTime system) {
  if (reached_ && steady <= *reached_) return;
  reached_ = steady;
  reached_system_ = system;
}

void RobotState::UpdatePresence(const PresenceLimits& limits) {
  const Presence presence = PresenceOf(Facts(reached_.value_or(server_started_)), limits);
  if (presence == presence_) return;
  presence_ = presence;
  presence_since_ = reached_system_;
  if (changed_) changed_(presence, presence_since_);
}

PresenceFacts RobotState::Facts(SteadyTime now) const {
  return {.now = now,
          .server_started = server_started_,
          .known_since = known_since_,
          .last_sign_of_life = last_sign_,
          .held_back = held_back_,
          .held_back_until = held_back_until_};
}

void RobotState::SignOfLife(SteadyTime steady, SystemTime system, const PresenceLimits& limits) {
  const std::lock_guard lock(mutex_);
  if (!last_sign_ || steady >= *last_sign_) {
    last_sign_ = steady;
    last_sign_system_ = system;
    signs_changed_ = true;
  }
  Reach(steady, system);
  UpdatePresence(limits);
}

void RobotState::SetReading(Reading reading, SteadyTime now) {
  const std::lock_guard lock(mutex_);
  const bool held_back = reading == Reading::kHeldBack;
  if (held_back_ && !held_back) held_back_until_ = stream_held_back_until_ = now;
  held_back_ = held_back;
}

void RobotState::NoteStall(SteadyTime now) {
  const std::lock_guard lock(mutex_);
  if (presence_ != Presence::kOffline) held_back_until_ = now;
}

void RobotState::NoteClockSkew(std::int64_t skew_ms) {
  const std::lock_guard lock(mutex_);
  clock_skew_ms_ = skew_ms;
  signs_changed_ = true;
}

void RobotState::StreamBegan() {
  const std::lock_guard lock(mutex_);
  fields_dropped_ = 0;
}

void RobotState::CountDropped(std::size_t fields) {
  const std::lock_guard lock(mutex_);
  fields_dropped_ += static_cast<std::int64_t>(fields);
}

std::optional<LiveChanges> RobotState::TakeChanges() {
  const std::lock_guard lock(mutex_);
  if (parts_changed_.none() && !signs_changed_) return std::nullopt;
  LiveChanges changes;
  changes.changed = std::exchange(parts_changed_, {});
  signs_changed_ = false;
  changes.last_sign_of_life = last_sign_system_;
  changes.clock_skew_ms = clock_skew_ms_;
  ForEachPart(
      [&changes]<typename Tag>(Tag /*row*/, const auto& from, auto& to) {
        if (changes.changed.test(Tag::kIndex)) to = from;
      },
      parts_, changes.parts);
  return changes;
}

void RobotState::PutBackChanges(const LivePartSet& changed) {
  const std::lock_guard lock(mutex_);
  parts_changed_ |= changed;
  signs_changed_ = true;
}

void RobotState::Restore(LiveBefore before) {
  const std::lock_guard lock(mutex_);
  ForEachPart(
      [this]<typename Tag>(Tag /*row*/, auto& part, auto& earlier) {
        if (Merge(part, std::move(earlier))) parts_changed_.set(Tag::kIndex);
      },
      parts_, before.parts);
  if (!last_sign_system_) last_sign_system_ = before.last_sign_of_life;
  if (!clock_skew_ms_) clock_skew_ms_ = before.clock_skew_ms;
}

Presence RobotState::Sweep(SteadyTime steady, SystemTime system, const PresenceLimits& limits) {
  const std::lock_guard lock(mutex_);
  Reach(steady, system);
  UpdatePresence(limits);
  return presence_;
}

Presence RobotState::presence() const {
  const std::lock_guard lock(mutex_);
  return presence_;
}

bool RobotState::held_back() const {
  const std::lock_guard lock(mutex_);
  return held_back_;
}

StateSnapshot RobotState::Snapshot(Parts parts) const {
  const std::lock_guard lock(mutex_);
  StateSnapshot snapshot{.parts = {},
                         .presence = presence_,
                         .presence_since = presence_since_,
                         .last_sign_of_life = last_sign_system_,
                         .clock_skew_ms = clock_skew_ms_,
                         .fields_dropped = fields_dropped_,
                         .keys_evicted = keys_evicted_};
  switch (parts) {
    case Parts::kNone:
      break;
    case Parts::kSmall:
      ForEachPart(
          []<typename Tag>(Tag /*row*/, const auto& from, auto& to) {
            if constexpr (Tag::kSmall) to = from;
          },
          parts_, snapshot.parts);
      break;
    case Parts::kAll:
      snapshot.parts = parts_;
      break;
  }
  return snapshot;
}

}  // namespace uplink::robot
