#pragma once

#include <span>
#include <string>

#include "server/rcan/fault_counts.h"
#include "server/rcan/named_series.h"
#include "server/robot/robot_state.h"

namespace uplink::rcan {

/// What the series of one robot are made of, beside its state.
struct SeriesSources {
  SystemTime now;
  /// The same moment by the other clock.
  SteadyTime steady_now;
  /// How long the values of a robot that went offline are shown (rcan.series_ttl).
  milliseconds series_ttl;
  /// A robot is offline when its last sign of life is older (presence.timeout).
  milliseconds presence_timeout{0};
  /// Keys of extras that are shown (rcan.extras).
  std::span<const std::string> extras;
  /// Null if they are not known.
  const FaultCounts::Map* faults = nullptr;
};

/// Adds the samples of one robot: its presence always, its values while they are shown. What is not
/// known has no sample. Series without a word of the robot's own come first, then the extras that
/// the operator asked for, then computers, then joints: none of these takes the place of one
/// before. Returns whether the values are shown. Called under the robot's lock.
bool AddRobot(const std::string& ruri, const robot::StateView& view, const SeriesSources& sources,
              NamedSeries& series);

}  // namespace uplink::rcan
