#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "metrics/rcan/page.h"
#include "server/rcan/named_series.h"
#include "server/robot/robot_state.h"
#include "server/view/fault_counts.h"

namespace uplink::rcan {

/// What the series of one robot need besides its state.
struct SeriesSources {
  SystemTime now;
  /// The same moment by the steady clock.
  SteadyTime steady_now;
  /// How long the values of a robot that went offline are shown (rcan.series_ttl).
  milliseconds series_ttl;
  /// A robot is offline when its last sign of life is older (presence.timeout).
  milliseconds presence_timeout{0};
  /// Keys of extras that are shown (rcan.extras).
  std::span<const std::string> extras = {};
  /// Null if they are unknown.
  const view::FaultCounts::Map* faults = nullptr;
};

/// Which values of a robot are shown.
enum class Shown : std::uint8_t {
  /// None, only its presence.
  kPresence,
  /// The values of its Robot States alone: without rcan.counts_as_life they come although the robot
  /// counts as silent.
  kStates,
  kAll,
};

/// Adds the basic samples of one robot, which carry no name of its own: its presence always, its
/// values while they are shown. An unknown value has no sample. Call it under the robot's lock.
Shown AddBasic(const std::string& ruri, const robot::StateView& view, const SeriesSources& sources,
               metrics::rcan::SeriesPage& page);

/// Adds the samples with a name of the robot's own: first the extras that the operator chose, then
/// computers, then joints, so that none of these takes the place of one before. Call it under the
/// robot's lock.
void AddNamed(const robot::StateView& view, Shown shown, std::span<const std::string> extras,
              NamedSeries& series);

}  // namespace uplink::rcan
