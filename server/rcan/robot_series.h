#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "metrics/rcan/page.h"
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
  std::span<const std::string> extras = {};
  /// Null if they are not known.
  const FaultCounts::Map* faults = nullptr;
};

/// Which values of a robot are shown.
enum class Shown : std::uint8_t {
  /// None, only its presence.
  kPresence,
  /// What its Robot States say: they are no sign of life where rcan.counts_as_life says so, and
  /// come all the same.
  kStates,
  kAll,
};

/// Adds the basic samples of one robot, which carry no word of its own: its presence always, its
/// values while they are shown. What is not known has no sample. Called under the robot's lock.
Shown AddBasic(const std::string& ruri, const robot::StateView& view, const SeriesSources& sources,
               metrics::rcan::SeriesPage& page);

/// Adds the samples with a word of the robot's own: first the extras that the operator asked for,
/// then computers, then joints, so that none of these takes the place of one before. Called under
/// the robot's lock.
void AddNamed(const robot::StateView& view, Shown shown, std::span<const std::string> extras,
              NamedSeries& series);

}  // namespace uplink::rcan
