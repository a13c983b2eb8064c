#pragma once

#include <atomic>
#include <cstdint>
#include <string>

namespace uplink::bench {

/// What a sink says once it is subscribed.
inline constexpr const char* kSinkReady = "subscribed";

/// How many messages a sink has taken, in a file that it and the benchmark map: reading it costs
/// the sink nothing. Thread-safe, across processes too.
class SinkCount final {
 public:
  /// Makes the file if there is none. Aborts if that fails.
  explicit SinkCount(const std::string& path);
  ~SinkCount();
  SinkCount(const SinkCount&) = delete;
  SinkCount& operator=(const SinkCount&) = delete;

  void Add() { count_->fetch_add(1, std::memory_order_relaxed); }
  [[nodiscard]] std::uint64_t Read() const { return count_->load(std::memory_order_relaxed); }

 private:
  using Count = std::atomic<std::uint64_t>;
  static_assert(Count::is_always_lock_free, "it lies in memory of two processes");

  Count* count_ = nullptr;
};

}  // namespace uplink::bench
