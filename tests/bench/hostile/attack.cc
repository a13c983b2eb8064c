#include "tests/bench/hostile/attack.h"

#include <algorithm>
#include <array>

namespace uplink::bench {
namespace {

using std::chrono::seconds;

/// By what they need: a timer of the server's that they are there to meet.
constexpr seconds kFirstStreamTimer{13};
constexpr seconds kHandshakeTimer{24};
constexpr seconds kStallTimer{36};
constexpr seconds kCrowdTime{8};
/// The server keeps what it needs for itself, and has few left.
constexpr int kFewDescriptors = 512;

constexpr std::array kAttacks = std::to_array<Attack>({
    {"announcement", "messages of 600 MB are announced, and trickle in", true, Announce},
    {"streams", "10,000 streams at once on a connection", true, OpenStreams},
    {"resets", "100,000 streams that are opened and reset at once", true, Reset},
    {"header_bombs", "a kept header of 4 KB, named 16,000 times per request", true, BombHeaders},
    {"long_headers", "200 KB of headers per request", true, LengthenHeaders},
    {"continuation", "headers that do not end", true, ContinueHeaders},
    {"settings", "200,000 SETTINGS", true, FloodSettings},
    {"pings", "200,000 PINGs", true, FloodPings},
    {"empty_data", "200,000 empty DATA frames", true, FloodEmptyData},
    {"window_overflow", "windows that overflow, of streams and connections", true, OverflowWindows},
    {"no_window", "rejected messages on and on, and no window for the answers", true, OpenNoWindow,
     kStallTimer},
    {"half_frame", "half a frame, and silence", true, SendHalfAFrame, kFirstStreamTimer},
    {"byte_per_second", "HTTP/2 by one byte per second", true, TrickleFrames, kFirstStreamTimer},
    {"silent_robot", "a handshake with a certificate, and silence", true, SayNothingAsRobot,
     kFirstStreamTimer},
    {"one_key", "700 connections of one certificate, with 16 streams each", true, CrowdOfOneKey},
    {"leave_robot", "handshakes with a certificate, each left at once", true, LeaveAsRobot},
    {"leave_nobody", "handshakes without a certificate, each left at once", false, LeaveAsNobody},
    {"half_open", "600 half-open handshakes", false, LeaveHalfOpen, kCrowdTime},
    {"byte_of_tls", "200 handshakes by one byte per second", false, TrickleHandshakes,
     kHandshakeTimer},
    {"silent_one", "2,000 connections of one address that say nothing", false, SayNothingFromOne,
     kCrowdTime},
    {"silent_fifty", "2,000 connections of fifty addresses that say nothing", false,
     SayNothingFromFifty, kCrowdTime},
    {"descriptors", "1,000 connections that say nothing, where 512 descriptors are allowed", false,
     TakeDescriptors, kHandshakeTimer, kFewDescriptors},
    {"explicit_curves", "14 connections that show 50 keys on curves that are written out", false,
     ShowExplicitCurves, kCrowdTime},
    {"dear_certificates", "14 connections that show the dearest certificates that are read", false,
     ShowDearCertificates, kCrowdTime},
});

testing::RawHttp2::Options ClientOf(const AttackSite& site) {
  testing::RawHttp2::Options options;
  options.port = site.port;
  options.server_ca = site.server_ca;
  options.source = kAttackerSource;
  options.patience = site.Left();
  return options;
}

}  // namespace

milliseconds AttackSite::Left() const {
  const auto left = std::chrono::ceil<milliseconds>(until - clock.Steady());
  return std::max(left, milliseconds(0));
}

testing::RawHttp2::Options AttackSite::Robot() const {
  testing::RawHttp2::Options options = ClientOf(*this);
  options.identity = identity;
  return options;
}

testing::RawHttp2::Options AttackSite::Nobody() const { return ClientOf(*this); }

std::span<const Attack> Attacks() { return kAttacks; }

const Attack* AttackOf(std::string_view name) {
  const auto* const found =
      std::ranges::find_if(kAttacks, [name](const Attack& attack) { return attack.name == name; });
  return found == kAttacks.end() ? nullptr : found;
}

}  // namespace uplink::bench
