#pragma once

#include <cstddef>
#include <cstdint>

namespace uplink::simulation {

/// A small seeded generator (splitmix64): the same seed gives the same run on every machine. A
/// value.
class Random final {
 public:
  /// Seeds that follow each other begin far apart: the numbers of one are not those of the next,
  /// moved by one.
  explicit Random(std::uint64_t seed) : state_(Mixed(seed + kStep)) {}

  std::uint64_t Next() {
    state_ += kStep;
    return Mixed(state_);
  }
  /// 0 to n-1.
  std::size_t Below(std::size_t n) { return static_cast<std::size_t>(Next() % n); }
  bool Percent(std::uint32_t percent) { return Below(100) < percent; }

 private:
  static constexpr std::uint64_t kStep = 0x9E3779B97F4A7C15ULL;
  static std::uint64_t Mixed(std::uint64_t z) {
    z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9ULL;
    z = (z ^ (z >> 27U)) * 0x94D049BB133111EBULL;
    return z ^ (z >> 31U);
  }

  std::uint64_t state_;
};

}  // namespace uplink::simulation
