#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>

#include "schema/model/rcan.h"
#include "tests/support/server_world.h"

namespace uplink::http {

/// More text of /metrics/robots than any kernel buffers for one connection.
inline void AddRobotsOfManyWords(testing::ServerWorld& world) {
  constexpr std::size_t kLong = 256;
  for (int i = 0; i < 5; ++i) {
    std::string ruri = "rcan://r/" + std::to_string(i);
    ruri.resize(kLong, 'r');
    model::RcanState state;
    for (int joint = 0; joint < 256; ++joint) {
      std::string name = "j" + std::to_string(joint) + "-";
      name.resize(kLong, 'j');
      state.joints.push_back({.joint = name,
                              .position_rad = 1,
                              .velocity_rad_s = 1,
                              .position_m = 1,
                              .velocity_m_s = 1,
                              .effort_nm = 1,
                              .temperature_c = 1,
                              .error_flags = 1,
                              .timestamp_us = 1});
    }
    world.AddRobot(ruri).state.Apply(std::move(state), world.clock.Steady());
  }
}

inline std::uint64_t ScrapesWritten(const testing::ServerWorld& world) {
  const auto& seconds = world.rcan_probe.scrape_seconds;
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i <= seconds.upper_bounds().size(); ++i) sum += seconds.count(i);
  return sum;
}

}  // namespace uplink::http
