#pragma once

#include <condition_variable>
#include <cstddef>
#include <mutex>

#include <absl/status/status.h>

#include "schema/base/clock.h"

namespace uplink::relay {

/// Admits streams up to a bound, until the server drains, and knows how many there are.
/// Thread-safe.
class Gate final {
 public:
  explicit Gate(std::size_t streams_max) : streams_max_(streams_max) {}

  /// A stream wants in; OK means it must Leave. kResourceExhausted at the bound, kUnavailable once
  /// closed.
  [[nodiscard]] absl::Status Enter();
  void Leave();
  /// Admits nobody from now on.
  void Close();

  [[nodiscard]] bool closed() const;
  [[nodiscard]] std::size_t streams() const;
  /// Waits until no stream is left, for `wait` at most; true if none is.
  [[nodiscard]] bool WaitEmpty(milliseconds wait) const;

 private:
  const std::size_t streams_max_;
  mutable std::mutex mutex_;
  mutable std::condition_variable empty_;
  std::size_t streams_ = 0;
  bool closed_ = false;
};

}  // namespace uplink::relay
