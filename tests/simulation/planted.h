#pragma once

#include "server/robot/mutation.h"

namespace uplink::robot {

/// Plants one fault for the runs that follow in this process, or none.
void Plant(Mutation mutation);

}  // namespace uplink::robot
