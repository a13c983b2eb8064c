#pragma once

#include <array>
#include <utility>

#include "tools/uplink-fleet/robot/histogram.h"

namespace uplink::synthetic {

/// The shares of all messages for which both reports say how long they took.
inline constexpr std::array<std::pair<const char*, double>, 4> kQuantiles = {
    {{"p50", 0.5}, {"p90", 0.9}, {"p99", 0.99}, {"p99.9", 0.999}}};

[[nodiscard]] inline double MillisOf(Histogram::Micros micros) {
  return static_cast<double>(micros.count()) / 1000;
}

}  // namespace uplink::synthetic
