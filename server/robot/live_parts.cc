#include "server/robot/live_parts.h"

#include <utility>
#include <variant>

#include "schema/base/check.h"

namespace uplink::robot {
namespace {

/// The key under which a consumable is held and shown: `kind/tankId`.
std::string ConsumableKey(const model::ConsumableStatus& status) {
  return status.kind + "/" + status.tank_id;
}

struct Put {
  LiveParts& parts;
  SteadyTime arrived;

  std::size_t operator()(model::MotionTelemetry&& body) const {
    parts.motion = std::move(body);
    return 0;
  }
  std::size_t operator()(model::StatusTelemetry&& body) const {
    // Copied: the text goes into the memory of the one before, and the message keeps its own, which
    // is used again (schema::Judge::Reuse).
    parts.status = std::as_const(body);
    return 0;
  }
  std::size_t operator()(model::TelemetryExtras&& body) const {
    std::size_t evicted = 0;
    for (model::SensorReading& reading : body.kv) {
      const std::int64_t sampled = reading.unix_time_ms.value_or(body.unix_time_ms);
      evicted += parts.extras.Put(
          std::move(reading.key),
          {.value = std::move(reading.value), .sampled_at_ms = sampled, .arrived = arrived});
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

std::size_t PutInto(LiveParts& parts, model::Body&& body, SteadyTime arrived) {
  return std::visit(Put{parts, arrived}, std::move(body));
}

}  // namespace uplink::robot
