#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace uplink::model::cyberwave {

/// What a message says of one joint. A channel that it leaves out keeps the value that it had. A
/// value.
struct Joint {
  /// Unique in its message, never empty.
  std::string name;
  /// Radians; of a prismatic joint metres.
  std::optional<double> position;
  /// Radians per second; of a prismatic joint metres per second.
  std::optional<double> velocity;
  /// Newton metres; of a prismatic joint newtons.
  std::optional<double> effort;
  /// Configured to be one that slides.
  bool prismatic = false;

  friend bool operator==(const Joint&, const Joint&) = default;
};

/// Joints of one moment, from `update` and `joint_states`. A value.
struct Joints {
  std::vector<Joint> joints;
  /// Wanted values beside the measured ones: counted, never state.
  std::size_t setpoints = 0;

  friend bool operator==(const Joints&, const Joints&) = default;
};

}  // namespace uplink::model::cyberwave
