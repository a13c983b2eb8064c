#pragma once

#include "tests/bench/hostile/attack.h"

// Attacks by what a stranger shows in its handshake.
namespace uplink::bench {

void ShowExplicitCurves(const AttackSite& site);
void ShowDearCertificates(const AttackSite& site);

}  // namespace uplink::bench
