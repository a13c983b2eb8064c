#pragma once

#include <atomic>

#include "storage/clock_trust.h"

namespace uplink::testing {

/// A clock that is vouched for as the test says, whatever the time. Thread-safe.
class FakeTrust final : public storage::ClockTrust {
 public:
  explicit FakeTrust(bool vouched = true) : vouched_(vouched) {}

  [[nodiscard]] bool vouched() const override { return vouched_.load(); }
  [[nodiscard]] bool VouchesFor(SystemTime /*time*/) const override { return vouched(); }
  void Set(bool vouched) { vouched_.store(vouched); }

 private:
  std::atomic<bool> vouched_;
};

}  // namespace uplink::testing
