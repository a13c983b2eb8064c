#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "schema/model/capabilities.h"
#include "schema/model/extras.h"
#include "schema/model/health.h"
#include "schema/model/mission.h"
#include "schema/model/motion.h"
#include "schema/model/rejection.h"
#include "schema/model/reports.h"
#include "schema/model/spatial.h"
#include "schema/model/status.h"

namespace uplink::schema {
class Judge;
}

namespace uplink::model {

/// The sixteen members of UplinkMsg; the numbers are the union's ordinals, and the order that of
/// Body's alternatives.
enum class Variant : std::uint8_t {
  kMissionRunStatus = 0,
  kMotionTelemetry = 1,
  kStatusTelemetry = 2,
  kTelemetryExtras = 3,
  kEventTelemetry = 4,
  kUiCapabilities = 5,
  kFault = 6,
  kShape = 7,
  kObject = 8,
  kSystemHealth = 9,
  kUsageTelemetry = 10,
  kConsumableStatus = 11,
  kCurrentSettings = 12,
  kMessage = 13,
  kAgentInfo = 14,
  kSpatialDirectiveStatus = 15,
};

inline constexpr std::size_t kVariants = 16;

using Body = std::variant<MissionRunStatus, MotionTelemetry, StatusTelemetry, TelemetryExtras,
                          EventTelemetry, UiCapabilities, Fault, ShapeOp, ObjectOp, SystemHealth,
                          UsageTelemetry, ConsumableStatus, CurrentSettings, Message, AgentInfo,
                          SpatialDirectiveStatus>;
static_assert(std::variant_size_v<Body> == kVariants);

/// The union member's name: `motionTelemetry`.
[[nodiscard]] std::string_view ToText(Variant variant);

/// True for the kinds that are settled by a commit; false for those that are settled when applied.
[[nodiscard]] bool IsDurable(Variant variant);

[[nodiscard]] inline Variant VariantOf(const Body& body) {
  return static_cast<Variant>(body.index());
}

/// A field of a live message that was at fault and was dropped (a status text: cut), while the rest
/// was applied. `field` is spelled as in Rejection.
using DroppedField = Rejection;

/// A validated message. Only a passing judgement makes one (schema::Judge), so whoever holds a
/// Record need not check it again. A value.
class Record {
 public:
  [[nodiscard]] Variant variant() const { return VariantOf(body_); }
  [[nodiscard]] bool durable() const { return IsDurable(variant()); }
  [[nodiscard]] const Body& body() const { return body_; }
  /// Moves the body out; the record must not be used afterwards.
  [[nodiscard]] Body&& TakeBody() && { return std::move(body_); }
  /// What judgement dropped; always empty for durable kinds.
  [[nodiscard]] std::span<const DroppedField> dropped() const { return dropped_; }
  /// Size of the serialized payload it came from.
  [[nodiscard]] std::size_t payload_bytes() const { return payload_bytes_; }

 private:
  friend class uplink::schema::Judge;
  Record(Body body, std::vector<DroppedField> dropped, std::size_t payload_bytes)
      : body_(std::move(body)), dropped_(std::move(dropped)), payload_bytes_(payload_bytes) {}

  Body body_;
  std::vector<DroppedField> dropped_;
  std::size_t payload_bytes_ = 0;
};

}  // namespace uplink::model
