#pragma once

#include <cstdint>
#include <limits>
#include <string>

#include "schema/model/record.h"
#include "schema/uplink.capnp.h"

/// One function per variant, in the file of its family: writes the model into the union member's
/// struct.
namespace uplink::schema {

// Parts of several families: encode/motion.cc, encode/value.cc
void EncodePose(const model::Pose& in, wire::Pose::Builder out);
void EncodeValue(const model::Value& in, wire::Value::Builder out);

void EncodeMember(const model::MissionRunStatus& in, wire::UplinkMsg::Builder message);
void EncodeMember(const model::MotionTelemetry& in, wire::UplinkMsg::Builder message);
void EncodeMember(const model::StatusTelemetry& in, wire::UplinkMsg::Builder message);
void EncodeMember(const model::TelemetryExtras& in, wire::UplinkMsg::Builder message);
void EncodeMember(const model::EventTelemetry& in, wire::UplinkMsg::Builder message);
void EncodeMember(const model::UiCapabilities& in, wire::UplinkMsg::Builder message);
void EncodeMember(const model::Fault& in, wire::UplinkMsg::Builder message);
void EncodeMember(const model::ShapeOp& in, wire::UplinkMsg::Builder message);
void EncodeMember(const model::ObjectOp& in, wire::UplinkMsg::Builder message);
void EncodeMember(const model::SystemHealth& in, wire::UplinkMsg::Builder message);
void EncodeMember(const model::UsageTelemetry& in, wire::UplinkMsg::Builder message);
void EncodeMember(const model::ConsumableStatus& in, wire::UplinkMsg::Builder message);
void EncodeMember(const model::CurrentSettings& in, wire::UplinkMsg::Builder message);
void EncodeMember(const model::Message& in, wire::UplinkMsg::Builder message);
void EncodeMember(const model::AgentInfo& in, wire::UplinkMsg::Builder message);
void EncodeMember(const model::SpatialDirectiveStatus& in, wire::UplinkMsg::Builder message);

/// How a number that was not measured, and has no hasX flag, is written.
inline constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
inline constexpr float kNanF = std::numeric_limits<float>::quiet_NaN();

/// How many items a list is made for.
[[nodiscard]] unsigned Count(const auto& items) { return static_cast<unsigned>(items.size()); }

/// Bytes of a text as Cap'n Proto takes them.
[[nodiscard]] inline capnp::Text::Reader Text(const std::string& text) {
  return {text.c_str(), text.size()};
}

/// Our member as the wire's; unknown numbers pass.
template <typename Wire, model::WireEnum Ours>
[[nodiscard]] Wire Enum(Ours value) {
  return static_cast<Wire>(static_cast<std::uint16_t>(value));
}

}  // namespace uplink::schema
