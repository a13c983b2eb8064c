#pragma once

#include <string>

#include "server/robot/robot_state.h"
#include "server/view/parts.h"
#include "server/view/text_members.h"

namespace uplink::view {

/// Adds the wanted live parts that are there, by their names in v1::Robot; a part that was never
/// reported is left out. `ruri` is the robot's. Pure.
void AddLiveParts(const robot::LiveParts& live, const PartSet& wanted, const std::string& ruri,
                  TextMembers& texts);

}  // namespace uplink::view
