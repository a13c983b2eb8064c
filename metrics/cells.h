#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>

#include <sched.h>

namespace uplink::metrics {

/// One counter or gauge that a component keeps in its probe and the exposition reads. Thread-safe;
/// relaxed, since no other data depends on it.
class Cell final {
 public:
  void Add(std::int64_t by = 1) { value_.fetch_add(by, std::memory_order_relaxed); }
  void Set(std::int64_t value) { value_.store(value, std::memory_order_relaxed); }
  [[nodiscard]] std::int64_t value() const { return value_.load(std::memory_order_relaxed); }

 private:
  std::atomic<std::int64_t> value_{0};
};

/// A counter of the hottest path: each core adds to a slot of its own, and a reader sums them, so
/// that threads do not take a cache line from each other. Thread-safe.
class CoreCell final {
 public:
  void Add(std::int64_t by = 1) {
    // Any slot will do, if threads that run at once mostly get different ones.
    const auto core = static_cast<std::size_t>(std::max(sched_getcpu(), 0));
    slots_[core % kSlots].value.fetch_add(by, std::memory_order_relaxed);
  }
  [[nodiscard]] std::int64_t value() const {
    std::int64_t sum = 0;
    for (const Slot& slot : slots_) sum += slot.value.load(std::memory_order_relaxed);
    return sum;
  }

 private:
  static constexpr std::size_t kSlots = 16;
  static constexpr std::size_t kCacheLineBytes = 64;
  struct alignas(kCacheLineBytes) Slot {
    std::atomic<std::int64_t> value{0};
  };

  std::array<Slot, kSlots> slots_{};
};

/// A histogram with fixed upper bounds, in the unit of its metric. Thread-safe.
template <std::size_t kBuckets>
class Distribution final {
 public:
  explicit Distribution(const std::array<double, kBuckets>& upper_bounds)
      : upper_bounds_(upper_bounds) {}

  void Observe(double value) {
    std::size_t bucket = 0;
    while (bucket < kBuckets && value > upper_bounds_[bucket]) ++bucket;
    counts_[bucket].fetch_add(1, std::memory_order_relaxed);
    // Nanounits keep the sum an integer, which adds without a loop.
    sum_nano_.fetch_add(static_cast<std::int64_t>(value * 1e9), std::memory_order_relaxed);
  }

  /// The seconds between two moments of one clock.
  template <typename Time>
  void ObserveSince(Time from, Time to) {
    Observe(std::chrono::duration<double>(to - from).count());
  }

  [[nodiscard]] const std::array<double, kBuckets>& upper_bounds() const { return upper_bounds_; }
  /// Observations in bucket `i`, not cumulative; `i` == kBuckets is the one above all bounds.
  [[nodiscard]] std::uint64_t count(std::size_t i) const {
    return counts_[i].load(std::memory_order_relaxed);
  }
  [[nodiscard]] double sum() const {
    return static_cast<double>(sum_nano_.load(std::memory_order_relaxed)) / 1e9;
  }

 private:
  const std::array<double, kBuckets> upper_bounds_;
  std::array<std::atomic<std::uint64_t>, kBuckets + 1> counts_{};
  std::atomic<std::int64_t> sum_nano_{0};
};

/// Bounds in seconds for waits that are a commit long: 0.5 ms to 30 s.
inline constexpr std::array<double, 12> kLatencyBoundsSeconds = {
    0.0005, 0.001, 0.0025, 0.005, 0.01, 0.025, 0.05, 0.1, 0.5, 2.5, 10.0, 30.0};
using LatencyDistribution = Distribution<12>;

/// Bounds for records in a batch.
inline constexpr std::array<double, 8> kBatchBounds = {1, 4, 16, 64, 128, 256, 512, 1000};
using BatchDistribution = Distribution<8>;

}  // namespace uplink::metrics
