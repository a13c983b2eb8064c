#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>

#include "server/robot/durable_flow.h"
#include "server/robot/rates.h"

namespace uplink::ingest {

/// How much one robot may send. Immutable.
struct Allowance {
  robot::FlowLimits flow;
  robot::RateTable rates{};
  /// The rate of telemetry (metrics::IsTelemetry), all kinds together.
  limits::BucketSize telemetry{};
};

/// The allowance of every robot, from any source; a reload of the configuration changes it.
/// Thread-safe.
class Allowances final {
 public:
  explicit Allowances(const Allowance& allowance = {}) { Set(allowance); }

  void Set(const Allowance& allowance);
  /// Grows with each Set, so that checking is cheap.
  [[nodiscard]] std::uint64_t version() const { return version_.load(std::memory_order_acquire); }
  [[nodiscard]] std::shared_ptr<const Allowance> Get() const;

 private:
  mutable std::mutex mutex_;
  std::shared_ptr<const Allowance> allowance_;
  std::atomic<std::uint64_t> version_{0};
};

}  // namespace uplink::ingest
