#pragma once

#include <atomic>
#include <cstdint>

namespace uplink::mqtt {

/// Numbers for connections, from 1, each given once. One for all clients of a process: a handle
/// names its connection by such a number, and must mean nothing to a client that is made anew.
///
/// Thread: any.
class ConnectionNumbers final {
 public:
  [[nodiscard]] std::uint64_t Next() { return ++last_; }

 private:
  std::atomic<std::uint64_t> last_{0};
};

}  // namespace uplink::mqtt
