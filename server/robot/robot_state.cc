#include "server/robot/robot_state.h"

#include <utility>

#include "schema/base/check.h"

namespace uplink::robot {
namespace {

/// The part that a live message changes.
storage::LivePart PartOf(model::Variant variant) {
  using enum model::Variant;
  switch (variant) {
    case kMotionTelemetry:
      return storage::LivePart::kMotion;
    case kStatusTelemetry:
      return storage::LivePart::kStatus;
    case kTelemetryExtras:
      return storage::LivePart::kExtras;
    case kSystemHealth:
      return storage::LivePart::kHealth;
    case kUsageTelemetry:
      return storage::LivePart::kUsage;
    case kConsumableStatus:
      return storage::LivePart::kConsumables;
    case kSpatialDirectiveStatus:
      return storage::LivePart::kDirectives;
    default:
      UPLINK_CHECK(false, "only live kinds are applied");
  }
}

/// Copies one part if it changed.
template <typename Part>
void CopyIf(const LivePartSet& changed, storage::LivePart kind, const Part& from, Part& to) {
  if (changed.test(static_cast<std::size_t>(kind))) to = from;
}

}  // namespace

void RobotState::Apply(std::vector<model::Record>& records, SteadyTime arrived) {
  const std::lock_guard lock(mutex_);
  for (model::Record& record : records) {
    if (record.variant() == model::Variant::kStatusTelemetry) status_arrived_ = arrived;
    parts_changed_.set(static_cast<std::size_t>(PartOf(record.variant())));
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
  using enum storage::LivePart;
  const std::lock_guard lock(mutex_);
  if (parts_changed_.none() && !signs_changed_) return std::nullopt;
  LiveChanges changes;
  changes.changed = std::exchange(parts_changed_, {});
  signs_changed_ = false;
  changes.last_sign_of_life = last_sign_system_;
  changes.clock_skew_ms = clock_skew_ms_;
  CopyIf(changes.changed, kMotion, parts_.motion, changes.parts.motion);
  CopyIf(changes.changed, kStatus, parts_.status, changes.parts.status);
  CopyIf(changes.changed, kExtras, parts_.extras, changes.parts.extras);
  CopyIf(changes.changed, kHealth, parts_.health, changes.parts.health);
  CopyIf(changes.changed, kUsage, parts_.usage, changes.parts.usage);
  CopyIf(changes.changed, kConsumables, parts_.consumables, changes.parts.consumables);
  CopyIf(changes.changed, kDirectives, parts_.directives, changes.parts.directives);
  CopyIf(changes.changed, kRcan, parts_.rcan, changes.parts.rcan);
  return changes;
}

void RobotState::PutBackChanges(const LivePartSet& changed) {
  const std::lock_guard lock(mutex_);
  parts_changed_ |= changed;
  signs_changed_ = true;
}

template <typename Part>
void RobotState::Merge(storage::LivePart kind, Part& part, Part before) {
  // The store has neither side whole then.
  if (!part.items().empty() && !before.items().empty()) {
    parts_changed_.set(static_cast<std::size_t>(kind));
  }
  part.PutOnTopOf(std::move(before));
}

void RobotState::Restore(LiveBefore before) {
  const std::lock_guard lock(mutex_);
  if (!parts_.motion) parts_.motion = std::move(before.parts.motion);
  if (!parts_.status) parts_.status = std::move(before.parts.status);
  if (!parts_.usage) parts_.usage = std::move(before.parts.usage);
  if (!parts_.rcan) parts_.rcan = std::move(before.parts.rcan);
  Merge(storage::LivePart::kExtras, parts_.extras, std::move(before.parts.extras));
  Merge(storage::LivePart::kHealth, parts_.health, std::move(before.parts.health));
  Merge(storage::LivePart::kConsumables, parts_.consumables, std::move(before.parts.consumables));
  Merge(storage::LivePart::kDirectives, parts_.directives, std::move(before.parts.directives));
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
    case Parts::kUnkeyed:
      snapshot.parts.motion = parts_.motion;
      snapshot.parts.status = parts_.status;
      snapshot.parts.usage = parts_.usage;
      break;
    case Parts::kAll:
      snapshot.parts = parts_;
      break;
  }
  return snapshot;
}

}  // namespace uplink::robot
