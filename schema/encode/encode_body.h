#pragma once

#include <cstdint>
#include <limits>
#include <string>

#include <capnp/message.h>

#include "schema/model/record.h"
#include "schema/uplink.capnp.h"

/// One function per variant, in the file of its family: writes the model into the union member's
/// struct.
namespace uplink::schema {

// Parts of several families: encode/motion.cc, encode/value.cc
void EncodePose(const model::Pose& in, wire::Pose::Builder out);
void EncodeValue(const model::Value& in, wire::Value::Builder out);

// One per row of model/variants.h.
#define UPLINK_VARIANT(Member, name, Body, settling) \
  void EncodeMember(const model::Body& in, wire::UplinkMsg::Builder message);
UPLINK_VARIANTS(UPLINK_VARIANT)
#undef UPLINK_VARIANT

/// The whole message in standard stream framing, not packed (encode.cc).
[[nodiscard]] std::string Framed(capnp::MessageBuilder& builder);

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
