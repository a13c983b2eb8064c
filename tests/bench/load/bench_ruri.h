#pragma once

#include <cstddef>
#include <string>

namespace uplink::bench {

/// The address of the robot of this number.
[[nodiscard]] inline std::string BenchRuri(std::size_t number) {
  return "rcan://bench.local/robots/" + std::to_string(number);
}

}  // namespace uplink::bench
