#pragma once

#include <condition_variable>
#include <cstddef>
#include <mutex>
#include <string>
#include <unordered_map>

#include <absl/status/status.h>

#include "schema/base/clock.h"
#include "server/transport/probe.h"

namespace uplink::transport {

/// Streams of one robot's certificate: one, two at takeover, four that wait since they come too
/// often, and one more to be told so.
inline constexpr std::size_t kStreamsPerCertificateMax = 8;

/// Admits streams up to a bound, and up to another one of each robot's certificate, until the
/// server drains, and knows how many there are. Thread-safe.
class Gate final {
 public:
  Gate(std::size_t streams_max, RelayProbe& probe) : streams_max_(streams_max), probe_(probe) {}

  /// A stream wants in, of this robot; of a gateway, "", which has no bound of its own. OK means it
  /// must Leave. kResourceExhausted at a bound, kUnavailable once closed; counted by cause.
  [[nodiscard]] absl::Status Enter(const std::string& robot);
  void Leave(const std::string& robot);
  /// Admits nobody from now on.
  void Close();

  [[nodiscard]] bool closed() const;
  [[nodiscard]] std::size_t streams() const;
  /// Waits until no stream is left, for `wait` at most; true if none is.
  [[nodiscard]] bool WaitEmpty(milliseconds wait) const;

 private:
  const std::size_t streams_max_;
  RelayProbe& probe_;
  mutable std::mutex mutex_;
  mutable std::condition_variable empty_;
  std::size_t streams_ = 0;
  /// Of each robot that has one.
  std::unordered_map<std::string, std::size_t> by_robot_;
  bool closed_ = false;
};

}  // namespace uplink::transport
