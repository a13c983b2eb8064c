#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace uplink::metrics {

/// Upper bounds of the ages of messages, in seconds: what a live view notices, then what an outage
/// leaves behind.
inline constexpr std::array<double, 13> kAgeBoundsSeconds = {0.1, 0.25, 0.5, 1,    2.5,  5,     10,
                                                             30,  60,   300, 1800, 7200, 86'400};
/// An older message counts as that old: one robot whose clock stands in 1970 would otherwise make
/// the sum useless.
inline constexpr std::chrono::hours kAgeCountedMax{24 * 30};

/// How a message is settled, as a label. Closed.
enum class AgeKind : std::uint8_t { kLive, kDurable };
inline constexpr std::array<std::string_view, 2> kAgeKinds = {"live", "durable"};

/// Ages of messages at their arrival: the server's clock less the time at which they were sampled,
/// by the robot's. Not corrected by the skew of its clock. A value, for one thread.
struct AgeCounts {
  /// By kAgeBoundsSeconds, not cumulative; the last is above all bounds.
  std::array<std::uint64_t, kAgeBoundsSeconds.size() + 1> counts{};
  double sum_seconds = 0;

  /// A negative age, of a clock that is ahead, counts as 0.
  void Add(std::chrono::milliseconds age) {
    const double seconds =
        std::chrono::duration<double>(std::clamp<std::chrono::milliseconds>(
                                          age, std::chrono::milliseconds(0), kAgeCountedMax))
            .count();
    std::size_t bucket = 0;
    while (bucket < kAgeBoundsSeconds.size() && seconds > kAgeBoundsSeconds[bucket]) ++bucket;
    ++counts[bucket];
    sum_seconds += seconds;
  }
  AgeCounts& operator+=(const AgeCounts& other) {
    for (std::size_t i = 0; i < counts.size(); ++i) counts[i] += other.counts[i];
    sum_seconds += other.sum_seconds;
    return *this;
  }
};

/// By AgeKind.
using MessageAges = std::array<AgeCounts, kAgeKinds.size()>;

}  // namespace uplink::metrics
