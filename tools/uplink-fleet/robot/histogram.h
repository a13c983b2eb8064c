#pragma once

#include <array>
#include <bit>
#include <chrono>
#include <cstddef>
#include <cstdint>

#include "schema/base/clock.h"

namespace uplink::synthetic {

/// Durations in buckets whose width grows with the value, as HdrHistogram has them: each is known
/// to 1/128 of itself, from a microsecond to an hour, in a fixed number of counters, and nothing is
/// left out at the upper end. Debian 12 has no such library for C++.
///
/// Thread: confined to one thread; Merge joins those of several.
class Histogram final {
 public:
  using Micros = std::chrono::microseconds;

  /// Negative durations count as none, longer ones than kMax as kMax.
  void Record(SteadyTime::duration duration) {
    const auto micros = std::chrono::duration_cast<Micros>(duration).count();
    const std::int64_t value = micros < 0 ? 0 : micros > kMax.count() ? kMax.count() : micros;
    ++counts_[IndexOf(static_cast<std::uint64_t>(value))];
    ++count_;
    if (value > max_.count()) max_ = Micros(value);
  }
  void Merge(const Histogram& other) {
    for (std::size_t i = 0; i < kBuckets; ++i) counts_[i] += other.counts_[i];
    count_ += other.count_;
    if (other.max_ > max_) max_ = other.max_;
  }

  [[nodiscard]] std::uint64_t count() const { return count_; }
  [[nodiscard]] Micros max() const { return max_; }
  /// The value that `share` (0 to 1) of all do not exceed; none is 0.
  [[nodiscard]] Micros Quantile(double share) const {
    const double wanted = share * static_cast<double>(count_);
    std::uint64_t seen = 0;
    for (std::size_t i = 0; i < kBuckets; ++i) {
      seen += counts_[i];
      if (counts_[i] > 0 && static_cast<double>(seen) >= wanted) {
        const Micros highest(static_cast<std::int64_t>(HighestOf(i)));
        return highest < max_ ? highest : max_;
      }
    }
    return max_;
  }

  static constexpr Micros kMax = std::chrono::hours(1);

 private:
  /// Values below 2^(kBits + 1) have a bucket each; above, each doubling has 2^kBits.
  static constexpr unsigned kBits = 7;
  static constexpr std::uint64_t kHalf = 1U << kBits;

  static constexpr std::size_t IndexOf(std::uint64_t value) {
    const auto width = static_cast<unsigned>(std::bit_width(value));
    const unsigned shift = width <= kBits + 1 ? 0 : width - kBits - 1;
    return static_cast<std::size_t>((shift << kBits) + (value >> shift));
  }
  static constexpr std::uint64_t HighestOf(std::size_t index) {
    if (index < 2 * kHalf) return index;
    const std::size_t shift = (index >> kBits) - 1;
    const std::uint64_t base = index - (shift << kBits);
    return ((base + 1) << shift) - 1;
  }
  /// An hour has 32 bits.
  static constexpr std::size_t kBuckets = (32 - kBits + 1) << kBits;

  std::array<std::uint64_t, kBuckets> counts_{};
  std::uint64_t count_ = 0;
  Micros max_{0};
};

/// From the time at which a message was due, whether or not the robot could send it then, to the
/// Ack that covered it.
struct Latencies {
  Histogram durable;
  /// Acks of live messages are cumulative: by count, and once in `limits.ack_interval`.
  Histogram live;
  /// Live messages that no Ack will ever cover: how long each waited until a newer one took its
  /// place before it was sent, or the server said that it had come too often.
  Histogram gave_way;
  /// From a stream's Welcome to the end of its first snapshot of what others share.
  Histogram snapshot;
  /// Of these, the first streams of robots that joined late.
  Histogram late_snapshot;

  void Merge(const Latencies& other) {
    durable.Merge(other.durable);
    live.Merge(other.live);
    gave_way.Merge(other.gave_way);
    snapshot.Merge(other.snapshot);
    late_snapshot.Merge(other.late_snapshot);
  }
};

}  // namespace uplink::synthetic
