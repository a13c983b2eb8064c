#include "server/fleet/robot_state.h"

#include <utility>

#include "schema/base/check.h"

namespace uplink::fleet {
namespace {

/// The key under which a consumable is held and shown: `kind/tankId`.
std::string ConsumableKey(const model::ConsumableStatus& status) {
  return status.kind + "/" + status.tank_id;
}

/// Puts one live body into the parts; returns the number of keys that had to go.
struct PutInto {
  LiveParts& parts;

  std::size_t operator()(model::MotionTelemetry&& body) const {
    parts.motion = std::move(body);
    return 0;
  }
  std::size_t operator()(model::StatusTelemetry&& body) const {
    parts.status = std::move(body);
    return 0;
  }
  std::size_t operator()(model::TelemetryExtras&& body) const {
    std::size_t evicted = 0;
    for (model::SensorReading& reading : body.kv) {
      const std::int64_t sampled = reading.unix_time_ms.value_or(body.unix_time_ms);
      evicted += parts.extras.Put(std::move(reading.key),
                                  {.value = std::move(reading.value), .sampled_at_ms = sampled});
    }
    return evicted;
  }
  std::size_t operator()(model::SystemHealth&& body) const {
    std::string key = body.device_id;
    return parts.health.Put(std::move(key), std::move(body));
  }
  std::size_t operator()(model::UsageTelemetry&& body) const {
    parts.usage = std::move(body);
    return 0;
  }
  std::size_t operator()(model::ConsumableStatus&& body) const {
    std::string key = ConsumableKey(body);
    return parts.consumables.Put(std::move(key), std::move(body));
  }
  std::size_t operator()(model::SpatialDirectiveStatus&& body) const {
    std::string key = body.directive_id;
    return parts.directives.Put(std::move(key), std::move(body));
  }
  template <typename Durable>
  std::size_t operator()(Durable&& /*body*/) const {
    UPLINK_CHECK(false, "only live kinds are applied");
    return 0;
  }
};

}  // namespace

void RobotState::Apply(std::vector<model::Record>& records) {
  const std::lock_guard lock(mutex_);
  for (model::Record& record : records) {
    keys_evicted_ += std::visit(PutInto{parts_}, std::move(record).TakeBody());
  }
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
  }
  Reach(steady, system);
  UpdatePresence(limits);
}

void RobotState::SetReading(Reading reading, SteadyTime now) {
  const std::lock_guard lock(mutex_);
  const bool held_back = reading == Reading::kHeldBack;
  if (held_back_ && !held_back) held_back_until_ = now;
  held_back_ = held_back;
}

void RobotState::NoteStall(SteadyTime now) {
  const std::lock_guard lock(mutex_);
  held_back_until_ = now;
}

void RobotState::NoteClockSkew(std::int64_t skew_ms) {
  const std::lock_guard lock(mutex_);
  clock_skew_ms_ = skew_ms;
}

void RobotState::StreamBegan() {
  const std::lock_guard lock(mutex_);
  fields_dropped_ = 0;
}

void RobotState::CountDropped(std::size_t fields) {
  const std::lock_guard lock(mutex_);
  fields_dropped_ += static_cast<std::int64_t>(fields);
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

}  // namespace uplink::fleet
