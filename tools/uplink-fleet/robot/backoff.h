#pragma once

#include <algorithm>
#include <cstdint>
#include <random>

#include "schema/base/clock.h"

namespace uplink::synthetic {

/// How long a robot waits before it connects again: 100 ms, then twice as long after each
/// failure, up to 2 s; drawn by chance from the upper half of that (protocol page: reconnecting).
///
/// Thread: confined to one thread.
class Backoff final {
 public:
  explicit Backoff(std::uint64_t seed) : random_(seed) {}

  void Failed() { ++failures_; }
  void Succeeded() { failures_ = 0; }

  /// The next wait; draws one number.
  [[nodiscard]] milliseconds Next() {
    const int doublings = std::min(failures_, kDoublingsMax);
    const auto most = std::min(kFirst * (1 << doublings), kMax);
    const std::int64_t half = most.count() / 2;
    return milliseconds(half) + milliseconds(random_() % static_cast<std::uint64_t>(half + 1));
  }

 private:
  static constexpr milliseconds kFirst{100};
  static constexpr milliseconds kMax{2000};
  static constexpr int kDoublingsMax = 5;

  std::mt19937_64 random_;
  int failures_ = 0;
};

}  // namespace uplink::synthetic
