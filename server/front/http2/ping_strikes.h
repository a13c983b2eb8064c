#pragma once

#include <chrono>
#include <cstdint>

#include "schema/base/clock.h"

namespace uplink::front {

/// Pings that come less than this after the one before count against the client.
inline constexpr std::chrono::seconds kPingGap{8};
/// Strikes that are forgiven. gRPC's default.
inline constexpr std::uint8_t kStrikesMax = 2;

/// Whether a client pings too often, by the rule of gRPC's servers (ping_abuse_policy.cc): a ping
/// is a strike if it comes within kPingGap of the one before and we sent no HEADERS or DATA in
/// between. Sending clears the strikes, since gRPC's clients measure the bandwidth by a ping after
/// our data; a good ping does not. Confined to the connection's thread.
class PingStrikes final {
 public:
  enum class Verdict : std::uint8_t {
    kInOrder,
    kForgiven,
    /// Send ENHANCE_YOUR_CALM, for this and every further strike.
    kTooMany,
  };

  [[nodiscard]] Verdict OnPing(SteadyTime now) {
    const bool strike = pinged_ && now - last_ping_ < kPingGap;
    last_ping_ = now;
    pinged_ = true;
    if (!strike) return Verdict::kInOrder;
    if (strikes_ <= kStrikesMax) ++strikes_;
    return strikes_ > kStrikesMax ? Verdict::kTooMany : Verdict::kForgiven;
  }
  /// We sent HEADERS or DATA.
  void OnSent() {
    pinged_ = false;
    strikes_ = 0;
  }

 private:
  SteadyTime last_ping_;
  /// A ping came since we last sent something: last_ping_ is valid.
  bool pinged_ = false;
  /// Up to kStrikesMax + 1.
  std::uint8_t strikes_ = 0;
};

/// Each of 10,000 connections has one.
static_assert(sizeof(PingStrikes) <= 16);

}  // namespace uplink::front
