#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "schema/base/clock.h"

namespace uplink::testing {

/// One TCP connection to a port of 127.0.0.1, from any loopback address. Every wait has an end.
/// Confined to one thread.
class RawTcp final {
 public:
  /// Bytes that one call of Receive gives at most.
  static constexpr std::size_t kReceiveBytesMax = std::size_t{64} * 1024;

  enum class End : std::uint8_t {
    /// The peer may still send.
    kNone,
    /// The peer said that nothing follows.
    kClosed,
    /// The connection broke: what was on its way is lost.
    kReset,
  };

  /// `source`: the address to come from, such as 127.0.0.5; empty: any.
  explicit RawTcp(std::uint16_t port, const std::string& source = {});
  ~RawTcp();
  RawTcp(const RawTcp&) = delete;
  RawTcp& operator=(const RawTcp&) = delete;

  /// As many of the bytes as the system takes now.
  [[nodiscard]] std::size_t SendSome(std::string_view bytes);
  /// What is there; nothing if none is, or at the end.
  [[nodiscard]] std::string Receive();
  enum class For : std::uint8_t { kInput, kInputOrOutput };
  /// Waits until there is something to do; false at `deadline`.
  [[nodiscard]] bool Wait(For what, SteadyTime deadline) const;
  /// Reads and forgets until the peer has ended; false if it does not within `patience`.
  [[nodiscard]] bool WaitForEnd(std::chrono::milliseconds patience);
  [[nodiscard]] End end() const { return end_; }

 private:
  int socket_ = -1;
  End end_ = End::kNone;
};

}  // namespace uplink::testing
