#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <limits>
#include <memory>
#include <utility>

namespace uplink::robot {

/// Memory of the live state of many owners, in bytes. Thread-safe.
class LiveTotal final {
 public:
  /// What counts here also counts in `all`, unless it is null.
  explicit LiveTotal(std::shared_ptr<LiveTotal> all = nullptr) : all_(std::move(all)) {}

  [[nodiscard]] std::size_t bytes() const { return bytes_.load(); }

  static constexpr std::size_t kNever = std::numeric_limits<std::size_t>::max();
  /// The function to call while more than the trigger is held. Set it before the trigger.
  void OnOver(std::function<void()> over) { over_ = std::move(over); }
  void SetTrigger(std::size_t bytes) { trigger_.store(bytes); }
  /// Call it after each change that may have added something, with no lock held.
  void Check() const {
    if (all_ != nullptr) return all_->Check();
    if (bytes_.load(std::memory_order_relaxed) > trigger_.load()) over_();
  }

 private:
  friend class LiveShare;
  void Change(std::size_t before, std::size_t after) {
    // Modulo 2^64, so that this subtracts too.
    bytes_.fetch_add(after - before);
    if (all_ != nullptr) all_->Change(before, after);
  }

  const std::shared_ptr<LiveTotal> all_;
  std::atomic<std::size_t> bytes_{0};
  std::atomic<std::size_t> trigger_{kNever};
  std::function<void()> over_;
};

/// The bytes of one robot or twin, which count in a total while it exists. Confined to its owner's
/// lock, except Check.
class LiveShare final {
 public:
  LiveShare() = default;
  ~LiveShare() { CountIn(nullptr); }
  LiveShare(const LiveShare&) = delete;
  LiveShare& operator=(const LiveShare&) = delete;

  /// Null: counts in no total. Set a total before the owner is shared between threads.
  void CountIn(std::shared_ptr<LiveTotal> total) {
    if (total_ != nullptr) total_->Change(bytes_, 0);
    total_ = std::move(total);
    if (total_ != nullptr) total_->Change(0, bytes_);
  }
  void Set(std::size_t bytes) {
    if (bytes == bytes_) return;
    if (total_ != nullptr) total_->Change(bytes_, bytes);
    bytes_ = bytes;
  }
  [[nodiscard]] std::size_t bytes() const { return bytes_; }

 private:
  std::shared_ptr<LiveTotal> total_;
  std::size_t bytes_ = 0;
};

}  // namespace uplink::robot
