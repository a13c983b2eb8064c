#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

/// The members of UplinkMsg, one row each, in the order of the union's ordinals from 0:
/// VARIANT(Member, name, Body, settling).
///
///   Member    as the accessors of the wire spell it: getMember, hasMember
///   name      as the schema spells it
///   Body      the struct of the model
///   settling  of model::Settling
///
/// The enumeration, model::Body, the switch of the judge and the declarations of `decode/`,
/// `encode/` and `json/` are made from these rows: a new variant is a row here, and the functions
/// of its family.
#define UPLINK_VARIANTS(VARIANT)                                            \
  VARIANT(MissionRunStatus, "missionRunStatus", MissionRunStatus, kDurable) \
  VARIANT(MotionTelemetry, "motionTelemetry", MotionTelemetry, kLive)       \
  VARIANT(StatusTelemetry, "statusTelemetry", StatusTelemetry, kLive)       \
  VARIANT(TelemetryExtras, "telemetryExtras", TelemetryExtras, kLive)       \
  VARIANT(EventTelemetry, "eventTelemetry", EventTelemetry, kDurable)       \
  VARIANT(UiCapabilities, "uiCapabilities", UiCapabilities, kDurable)       \
  VARIANT(Fault, "fault", Fault, kDurable)                                  \
  VARIANT(Shape, "shape", ShapeOp, kDurable)                                \
  VARIANT(Object, "object", ObjectOp, kDurable)                             \
  VARIANT(SystemHealth, "systemHealth", SystemHealth, kLive)                \
  VARIANT(UsageTelemetry, "usageTelemetry", UsageTelemetry, kLive)          \
  VARIANT(ConsumableStatus, "consumableStatus", ConsumableStatus, kLive)    \
  VARIANT(CurrentSettings, "currentSettings", CurrentSettings, kDurable)    \
  VARIANT(Message, "message", Message, kDurable)                            \
  VARIANT(AgentInfo, "agentInfo", AgentInfo, kDurable)                      \
  VARIANT(SpatialDirectiveStatus, "spatialDirectiveStatus", SpatialDirectiveStatus, kLive)

namespace uplink::model {

/// How a kind is settled: a live message when it is applied, a durable one when it is committed.
enum class Settling : std::uint8_t { kLive, kDurable };

/// The members of UplinkMsg; the numbers are the union's ordinals, and the order that of Body's
/// alternatives.
enum class Variant : std::uint8_t {
#define UPLINK_VARIANT(Member, name, Body, settling) k##Member,
  UPLINK_VARIANTS(UPLINK_VARIANT)
#undef UPLINK_VARIANT
};

#define UPLINK_VARIANT(Member, name, Body, settling) +1  // NOLINT(bugprone-macro-parentheses): sum
inline constexpr std::size_t kVariants = UPLINK_VARIANTS(UPLINK_VARIANT);
#undef UPLINK_VARIANT

/// The union member's name: `motionTelemetry`.
[[nodiscard]] std::string_view ToText(Variant variant);

/// True for the kinds that are settled by a commit; false for those that are settled when applied.
[[nodiscard]] bool IsDurable(Variant variant);

}  // namespace uplink::model
