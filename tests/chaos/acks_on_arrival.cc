// Linked into a program with the broker's commits in their mutable form: messages are acked when
// they come, before the commit.
#include "server/robot/mutation.h"

namespace uplink::robot {

bool Planted(Mutation mutation) { return mutation == Mutation::kMessageAckedOnArrival; }

}  // namespace uplink::robot
