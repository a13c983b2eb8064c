#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <random>
#include <string>

#include "schema/model/ids.h"

// What all robots of the benchmarks have.
namespace uplink::bench {

inline constexpr const char* kRelayMethod = "/uplink.v1.UplinkRelay/Relay";

/// The address of the robot of this number.
[[nodiscard]] inline std::string BenchRuri(std::size_t number) {
  return "rcan://bench.local/robots/" + std::to_string(number);
}

/// Random bytes for a new numbering.
[[nodiscard]] inline model::SessionId NewSessionId() {
  std::random_device random;
  std::array<std::uint8_t, model::SessionId::kBytes> bytes{};
  std::ranges::generate(bytes, [&] { return static_cast<std::uint8_t>(random()); });
  return model::SessionId(bytes);
}

}  // namespace uplink::bench
