#pragma once

#include "server/robot/robot_state.h"
#include "server/view/parts.h"
#include "uplink/v1/fleet.pb.h"

namespace uplink::view {

/// Sets the wanted live parts that are there; a part that was never reported stays unset. Pure.
void SetLiveParts(const robot::LiveParts& live, const PartSet& wanted, v1::Robot& robot);

}  // namespace uplink::view
