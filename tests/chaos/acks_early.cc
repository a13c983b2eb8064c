// Linked into a program with the sessions' sources in their mutable form: acks go out before the
// commit.
#include "server/robot/mutation.h"

namespace uplink::robot {

bool Planted(Mutation mutation) { return mutation == Mutation::kAckBeforeCommit; }

}  // namespace uplink::robot
