#pragma once

#include "tests/bench/hostile/attack.h"

// Attacks by many connections, and by slow ones.
namespace uplink::bench {

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

}  // namespace uplink::bench
