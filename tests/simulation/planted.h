#pragma once

#include "server/session/mutation.h"

namespace uplink::session {

/// Plants one fault for the runs that follow in this process, or none.
void Plant(Mutation mutation);

}  // namespace uplink::session
