#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include "schema/model/enum_text.h"

namespace uplink::model {

/// Where something is. A value.
struct Pose {
  double lat_deg = 0;
  double lon_deg = 0;
  /// Metres above the ellipsoid; absent if not known.
  std::optional<double> altitude_m;
  /// Clockwise from north, in [0, 360); absent if not known.
  std::optional<double> heading_deg;

  friend bool operator==(const Pose&, const Pose&) = default;
};

/// Velocity; a part is absent only if judgement dropped it.
struct VelTwist {
  std::optional<float> linear_mps;
  std::optional<float> angular_rps;

  friend bool operator==(const VelTwist&, const VelTwist&) = default;
};

enum class GpsFixType : std::uint16_t {
  kUnknown = 0,
  kInvalid = 1,
  kGps = 2,
  kDgps = 3,
  kSbas = 4,
  kFloatRtk = 5,
  kFixedRtk = 6,
  kPps = 7,
};
template <>
inline constexpr auto kEnumNames<GpsFixType> = std::to_array<std::string_view>(
    {"unknown", "invalid", "gps", "dgps", "sbas", "floatRtk", "fixedRtk", "pps"});

enum class GpsSource : std::uint16_t { kReal = 0, kSimulated = 1, kEstimated = 2 };
template <>
inline constexpr auto kEnumNames<GpsSource> = std::to_array<std::string_view>({"real", "simulated",
                                                                               "estimated"});

/// Pose and velocity. Live. A value.
struct MotionTelemetry {
  /// Sample time, Unix milliseconds; 0 if unknown.
  std::int64_t unix_time_ms = 0;
  std::optional<Pose> pose;
  std::optional<VelTwist> velocity;
  std::optional<GpsFixType> gps_fix_type;
  GpsSource gps_source = GpsSource::kReal;

  friend bool operator==(const MotionTelemetry&, const MotionTelemetry&) = default;
};

}  // namespace uplink::model
