#pragma once

#include <chrono>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "schema/base/clock.h"
#include "tests/support/raw_http2.h"

namespace uplink::bench {

/// Where an attack goes, with what, and until when. A value.
struct AttackSite {
  const Clock& clock;
  std::uint16_t port = 0;
  /// The authority that the server's certificate comes from.
  std::string server_ca;
  /// The attacker's certificate, of a robot that the server trusts.
  testing::KeyPair identity;
  SteadyTime until;

  [[nodiscard]] bool Over() const { return clock.Steady() >= until; }
  /// Zero once it is over.
  [[nodiscard]] milliseconds Left() const;
  /// A client with the certificate, and one without; neither waits longer than the attack lasts.
  [[nodiscard]] testing::RawHttp2::Options Robot() const;
  [[nodiscard]] testing::RawHttp2::Options Nobody() const;
};

/// What the attacker's robot is called, and the address that all but a few attacks come from.
inline constexpr std::string_view kAttackerRuri = "rcan://bench.local/robots/attacker";
inline constexpr std::string_view kAttackerSource = "127.0.0.66";
/// Attacks from many addresses come from `127.0.0.100` and those that follow.
inline constexpr std::size_t kFirstOfManySources = 100;
inline constexpr std::size_t kManySources = 50;

/// One way to harm a server. It is bounded by its own counts and by the site's time.
///
/// Errors: that the server ends it, refuses it or is gone is what is measured.
/// Thread: `run` blocks the thread that it has to itself.
struct Attack {
  std::string_view name;
  /// A line for people.
  std::string_view about;
  bool has_certificate = false;
  void (*run)(const AttackSite&) = nullptr;
  /// It shows nothing in less.
  std::chrono::seconds time_min{0};
  /// Descriptors that the server may have; 0: no limit of the attack's.
  int descriptors_max = 0;
};

/// In the order of a whole run.
[[nodiscard]] std::span<const Attack> Attacks();
/// Null if there is none of that name.
[[nodiscard]] const Attack* AttackOf(std::string_view name);

// Attacks by what is said on HTTP/2, with a certificate. Where the server ends a connection the
// attacker comes back, some times.
void Announce(const AttackSite& site);
void OpenStreams(const AttackSite& site);
void Reset(const AttackSite& site);
void BombHeaders(const AttackSite& site);
void LengthenHeaders(const AttackSite& site);
void ContinueHeaders(const AttackSite& site);
void FloodSettings(const AttackSite& site);
void FloodPings(const AttackSite& site);
void FloodEmptyData(const AttackSite& site);
void OverflowWindows(const AttackSite& site);
void OpenNoWindow(const AttackSite& site);

// By many connections, and by slow ones.
void SendHalfAFrame(const AttackSite& site);
void TrickleFrames(const AttackSite& site);
void SayNothingAsRobot(const AttackSite& site);
void CrowdOfOneKey(const AttackSite& site);
void LeaveAsRobot(const AttackSite& site);
void LeaveAsNobody(const AttackSite& site);
void LeaveHalfOpen(const AttackSite& site);
void TrickleHandshakes(const AttackSite& site);
void SayNothingFromOne(const AttackSite& site);
void SayNothingFromFifty(const AttackSite& site);
void TakeDescriptors(const AttackSite& site);

// By what a stranger shows in its handshake.
void ShowExplicitCurves(const AttackSite& site);
void ShowDearCertificates(const AttackSite& site);

}  // namespace uplink::bench
