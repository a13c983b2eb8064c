#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "schema/model/enum_text.h"
#include "schema/model/value.h"
#include "schema/rules/motion.h"
#include "schema/rules/path.h"
#include "schema/rules/violations.h"
#include "schema/uplink.capnp.h"

/// What the decoders share: Cap'n Proto's field types as ours.
namespace uplink::schema {

[[nodiscard]] inline std::string_view View(capnp::Text::Reader text) {
  return {text.begin(), text.size()};
}

/// The member as ours; its number is kept, and counted, if we do not know it.
template <model::WireEnum Ours, typename Wire>
[[nodiscard]] Ours Enum(Violations& violations, Wire value) {
  const auto ours = static_cast<Ours>(static_cast<std::uint16_t>(value));
  if (!model::IsRecognized(ours)) violations.CountUnrecognized();
  return ours;
}

[[nodiscard]] inline RawPose Raw(wire::Pose::Reader in) {
  return {.lat_deg = in.getLatDeg(),
          .lon_deg = in.getLonDeg(),
          .altitude_m = in.getAltitudeM(),
          .heading_deg = in.getHeadingDeg()};
}

/// A Value with its rules; nothing after reporting a violation of content at `path`
/// (decode/value.cc).
[[nodiscard]] std::optional<model::Value> JudgeValue(Violations& violations, const Path& path,
                                                     wire::Value::Reader in);

}  // namespace uplink::schema
