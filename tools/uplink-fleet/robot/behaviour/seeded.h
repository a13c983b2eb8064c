#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace uplink::synthetic {

/// A small seeded source of chance: eight bytes of state, so that each behaviour of each robot has
/// its own and none changes what another does. Not for secrets. A value.
/// Source: Steele, Lea, Flood, "Fast splittable pseudorandom number generators" (splitmix64).
class Seeded final {
 public:
  explicit Seeded(std::uint64_t seed) : state_(seed) {}

  [[nodiscard]] std::uint64_t Next() {
    std::uint64_t z = (state_ += 0x9E37'79B9'7F4A'7C15ULL);
    z = (z ^ (z >> 30U)) * 0xBF58'476D'1CE4'E5B9ULL;
    z = (z ^ (z >> 27U)) * 0x94D0'49BB'1331'11EBULL;
    return z ^ (z >> 31U);
  }
  /// In [0, 1).
  [[nodiscard]] double Unit() { return static_cast<double>(Next() >> 11U) * 0x1.0p-53; }
  [[nodiscard]] double Between(double low, double high) { return low + (high - low) * Unit(); }
  [[nodiscard]] bool Chance(double probability) { return Unit() < probability; }
  /// In [0, n); n > 0.
  [[nodiscard]] std::size_t Below(std::size_t n) { return static_cast<std::size_t>(Next() % n); }

 private:
  std::uint64_t state_;
};

/// Says when a period has passed; a first one may be shorter, so that robots do not act in step.
class Every final {
 public:
  Every(double period_s, double first_s) : period_s_(period_s), left_s_(first_s) {}
  void SetPeriod(double period_s) {
    period_s_ = period_s;
    left_s_ = std::min(left_s_, period_s);
  }
  [[nodiscard]] bool Passed(double dt_s) {
    left_s_ -= dt_s;
    if (left_s_ > 0) return false;
    left_s_ = std::max(left_s_ + period_s_, 0.0);
    return true;
  }

 private:
  double period_s_;
  double left_s_;
};

}  // namespace uplink::synthetic
