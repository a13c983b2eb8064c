#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "schema/base/clock.h"

namespace uplink::session {

/// What a stream waits for until a deadline.
enum class Timer : std::uint8_t {
  /// The first frame (kHelloWait).
  kHello,
  /// Its turn, because streams of its robot come too often (robot::Reconnects).
  kAttach,
  /// The store's answer, before Welcome goes out without it (kWelcomeWait).
  kWelcome,
  /// The end of a stream that settles (drain.timeout).
  kSettle,
  /// The peer to read, while its outgoing queue is full (kPeerStallMax).
  kStall,
  /// The next Ack (limits.ack_interval).
  kAck,
  /// The next attempt to read Rejects (kRejectsReadAgain).
  kReadRejects,
  /// The end of a throttle, when the stream is read again.
  kReadAgain,
  /// The next ResendRequest (kResendGrace, robot::kResendEvery).
  kResend,
  /// The rate to allow the latest telemetry over it to be decoded (Surplus).
  kSurplus,
};
inline constexpr std::size_t kTimers = 10;

/// The deadlines of one stream, at most one for each Timer. Confined to the stream's thread.
class StreamTimers final {
 public:
  void Set(Timer timer, SteadyTime at) { At(timer) = at; }
  void Clear(Timer timer) { At(timer).reset(); }
  [[nodiscard]] bool is_set(Timer timer) const { return at(timer).has_value(); }
  /// Empty if it is not set.
  [[nodiscard]] const std::optional<SteadyTime>& at(Timer timer) const {
    return at_[static_cast<std::size_t>(timer)];
  }
  /// It is set and has come.
  [[nodiscard]] bool Due(Timer timer, SteadyTime now) const {
    return is_set(timer) && now >= *at(timer);
  }
  /// The earliest deadline; empty if none is set.
  [[nodiscard]] std::optional<SteadyTime> Next() const {
    std::optional<SteadyTime> first;
    for (const std::optional<SteadyTime>& at : at_) {
      if (at && (!first || *at < *first)) first = at;
    }
    return first;
  }

 private:
  [[nodiscard]] std::optional<SteadyTime>& At(Timer timer) {
    return at_[static_cast<std::size_t>(timer)];
  }

  std::array<std::optional<SteadyTime>, kTimers> at_;
};

}  // namespace uplink::session
