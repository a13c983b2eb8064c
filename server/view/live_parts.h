#pragma once

#include "server/fleet/robot_state.h"
#include "server/view/parts.h"
#include "uplink/v1/fleet.pb.h"

namespace uplink::view {

/// Sets the wanted live parts that are there; a part that was never reported stays unset. Pure.
void SetLiveParts(const fleet::LiveParts& live, const PartSet& wanted, v1::Robot& robot);

}  // namespace uplink::view
