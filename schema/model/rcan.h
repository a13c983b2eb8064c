#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

/// RCAN section 20: what a robot says of itself in one Robot State. Names, types and units are the
/// specification's; a value that it leaves out is absent.
namespace uplink::model {

/// One joint at one moment. A value.
struct RcanJoint {
  /// Unique in its state, never empty.
  std::string joint;
  std::optional<double> position_rad;
  std::optional<double> velocity_rad_s;
  /// In place of the two above on a prismatic joint.
  std::optional<double> position_m;
  std::optional<double> velocity_m_s;
  /// Newton metres; of a prismatic joint newtons.
  std::optional<double> effort_nm;
  std::optional<double> temperature_c;
  /// The vendor's bits.
  std::optional<std::uint64_t> error_flags;
  /// Microseconds since the Unix epoch, by the robot's clock.
  std::int64_t timestamp_us = 0;

  friend bool operator==(const RcanJoint&, const RcanJoint&) = default;
};

/// Where a robot is in a frame of its own. A value.
struct RcanPosition {
  double x_m = 0;
  double y_m = 0;
  /// Positive is counter-clockwise.
  std::optional<double> heading_rad;

  friend bool operator==(const RcanPosition&, const RcanPosition&) = default;
};

/// One Robot State, without the robot's name. A value.
struct RcanState {
  /// At least 1.
  std::optional<std::int64_t> seq;
  /// Milliseconds since the robot's process started.
  std::optional<std::int64_t> uptime_ms;
  std::optional<double> battery_v;
  /// 0 to 100.
  std::optional<std::int64_t> battery_pct;
  std::optional<RcanPosition> position;
  std::vector<RcanJoint> joints;
  /// `ntp`, `ptp`, `rtc`, or what the robot says.
  std::optional<std::string> clock_source;
  /// Microseconds since the Unix epoch, by the robot's clock.
  std::int64_t timestamp_us = 0;
  /// Numbers of `seq` that were skipped since the stream began. The server's own count.
  std::uint64_t seq_missing = 0;

  friend bool operator==(const RcanState&, const RcanState&) = default;
};

}  // namespace uplink::model
