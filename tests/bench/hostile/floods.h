#pragma once

#include "tests/bench/hostile/attack.h"

// Attacks by what is said on HTTP/2, with a certificate. Where the server ends a connection the
// attacker comes back, up to kConnectionsMax times.
namespace uplink::bench {

inline constexpr int kConnectionsMax = 50;

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

}  // namespace uplink::bench
