// Linked into a program with the sources that judge what the store has, in their mutable form: a
// store that was connected to anew counts as having all that it told before.
#include "server/robot/mutation.h"

namespace uplink::robot {

bool Planted(Mutation mutation) { return mutation == Mutation::kReconnectTrusted; }

}  // namespace uplink::robot
