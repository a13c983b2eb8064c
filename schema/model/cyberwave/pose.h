#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace uplink::model::cyberwave {

/// Where a twin is in the frame of its environment's world. A value.
struct Position {
  double x_m = 0;
  double y_m = 0;
  double z_m = 0;

  friend bool operator==(const Position&, const Position&) = default;
};

/// How a twin is turned: a quaternion as it was sent, which need not have length 1; never all 0. A
/// value.
struct Rotation {
  double w = 1;
  double x = 0;
  double y = 0;
  double z = 0;

  friend bool operator==(const Rotation&, const Rotation&) = default;
};

/// By what a twin's model is stretched when it is drawn. A value.
struct Scale {
  double x = 1;
  double y = 1;
  double z = 1;

  friend bool operator==(const Scale&, const Scale&) = default;
};

/// What a satellite receiver says; absent is not known. A value.
struct Gps {
  /// Both or neither.
  std::optional<double> latitude_deg;
  std::optional<double> longitude_deg;
  std::optional<double> altitude_m;
  /// From 0 to below 360, clockwise from north.
  std::optional<double> compass_heading_deg;
  std::optional<double> horizontal_accuracy_m;
  std::optional<double> vertical_accuracy_m;
  std::optional<std::uint64_t> satellite_count;
  /// In a unit of the driver's own.
  std::optional<double> signal_level;
  /// The driver's word, such as `3d` or `rtk_fixed`; empty if there is none.
  std::string fix_type;

  friend bool operator==(const Gps&, const Gps&) = default;
};

}  // namespace uplink::model::cyberwave
