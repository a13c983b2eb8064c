#pragma once

#include <chrono>
#include <cstdint>

#include "schema/base/clock.h"

namespace uplink::front {

/// Pings that come less than this after the one before count against the client.
inline constexpr std::chrono::seconds kPingGap{8};
/// Strikes that are forgiven; the next one is too many. gRPC's default.
inline constexpr std::uint8_t kStrikesMax = 2;

/// Whether a client pings too often, as gRPC's servers judge it (ping_abuse_policy.cc): a ping is a
/// strike if it comes within kPingGap of the one before, and we sent no HEADERS or DATA since. What
/// we send clears the strikes, for gRPC's clients measure the bandwidth by a ping after our data; a
/// ping in order does not. Confined to the connection's thread.
class PingStrikes final {
 public:
  enum class Verdict : std::uint8_t {
    kInOrder,
    kForgiven,
    /// The client is to be told ENHANCE_YOUR_CALM. So is every further strike.
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
  /// There was a ping since we sent something last: last_ping_ holds.
  bool pinged_ = false;
  /// Up to kStrikesMax + 1.
  std::uint8_t strikes_ = 0;
};

/// Each of 10,000 connections has one.
static_assert(sizeof(PingStrikes) <= 16);

}  // namespace uplink::front
