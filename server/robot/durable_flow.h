#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <optional>

#include "schema/base/clock.h"
#include "server/limits/policies.h"
#include "server/limits/token_bucket.h"
#include "server/robot/held_back.h"

namespace uplink::robot {

/// How much one robot may store (limits.durable_*). A value.
struct FlowLimits {
  limits::BucketSize records = limits::PolicyOf(limits::PolicyId::kRecordsOfRobot).bucket();
  limits::BucketSize bytes = limits::PolicyOf(limits::PolicyId::kBytesOfRobot).bucket();
};

/// What one robot stores per second. Past its buckets its stream is held back, and nothing is lost.
/// If the store's disk is nearly full, less is allowed (LimitForDisk).
///
/// Thread: thread-safe: a robot may speak by a stream and by calls.
class DurableFlow final {
 public:
  /// Whether a record of `bytes` may be stored now, and otherwise when to look again.
  struct Answer {
    /// kNone, kFlow or kDisk.
    HeldBack by = HeldBack::kNone;
    SteadyTime again{};
  };
  [[nodiscard]] Answer LookAt(std::size_t bytes, const FlowLimits& limits, SteadyTime now) const;
  /// Counts a record that is stored, whatever LookAt returned.
  void Take(std::size_t bytes, const FlowLimits& limits, SteadyTime now);

  /// Counts bytes that are stored without taking from the buckets: the payload of a rejection, and
  /// what a broker delivers past the flow, such as a backlog.
  void CountKept(std::size_t bytes) { bytes_total_.fetch_add(bytes, std::memory_order_relaxed); }
  /// The store's disk allows less, or nothing: payloads of rejections are not kept.
  [[nodiscard]] bool disk_limits() const { return disk_rate_.load() != kNoLimit; }
  /// Whether anything may be stored at all, even what the flow does not count.
  [[nodiscard]] Answer LookAtDisk(SteadyTime now) const;

  /// Bytes that were taken or kept since the start.
  [[nodiscard]] std::uint64_t bytes_total() const { return bytes_total_.load(); }
  /// Allows so many bytes per second at most: at 0 none; empty: no such limit.
  void LimitForDisk(std::optional<std::uint64_t> bytes_per_second);

 private:
  /// The value of disk_rate_ without a limit.
  static constexpr std::int64_t kNoLimit = -1;
  [[nodiscard]] limits::BucketSize DiskSize(std::int64_t rate) const;

  mutable std::mutex mutex_;
  limits::TokenBucket records_;
  limits::TokenBucket bytes_;
  limits::TokenBucket disk_;
  std::atomic<std::uint64_t> bytes_total_{0};
  std::atomic<std::int64_t> disk_rate_{kNoLimit};
};

}  // namespace uplink::robot
