#pragma once

#include <atomic>
#include <cstddef>
#include <memory>
#include <utility>

namespace uplink::journal {

/// The entries of all robots of one gateway that wait in one journal.
///
/// Thread: thread-safe.
class GatewayUse final {
 public:
  /// Gaps included.
  [[nodiscard]] std::size_t records() const { return records_.load(); }
  [[nodiscard]] std::size_t bytes() const { return bytes_.load(); }

 private:
  friend class GatewayPlace;

  std::atomic<std::size_t> records_{0};
  std::atomic<std::size_t> bytes_{0};
};

/// Null: the robot has no gateway.
using GatewayRef = std::shared_ptr<GatewayUse>;

/// Counts one entry in its gateway's use while it exists.
///
/// Thread: confined to the owner of the entry.
class GatewayPlace final {
 public:
  GatewayPlace() = default;
  GatewayPlace(GatewayRef gateway, std::size_t bytes)
      : gateway_(std::move(gateway)), bytes_(bytes) {
    if (gateway_ == nullptr) return;
    gateway_->records_.fetch_add(1);
    gateway_->bytes_.fetch_add(bytes_);
  }
  ~GatewayPlace() {
    if (gateway_ == nullptr) return;
    gateway_->records_.fetch_sub(1);
    gateway_->bytes_.fetch_sub(bytes_);
  }
  GatewayPlace(GatewayPlace&& other) noexcept = default;
  GatewayPlace& operator=(GatewayPlace&& other) noexcept {
    std::swap(gateway_, other.gateway_);
    std::swap(bytes_, other.bytes_);
    return *this;
  }
  GatewayPlace(const GatewayPlace&) = delete;
  GatewayPlace& operator=(const GatewayPlace&) = delete;

  [[nodiscard]] const GatewayRef& gateway() const { return gateway_; }

 private:
  GatewayRef gateway_;
  std::size_t bytes_ = 0;
};

}  // namespace uplink::journal
