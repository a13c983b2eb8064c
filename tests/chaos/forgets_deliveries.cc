// Linked into a program with the broker's commits in their mutable form: what a broker delivers
// again counts as new.
#include "server/robot/mutation.h"

namespace uplink::robot {

bool Planted(Mutation mutation) { return mutation == Mutation::kRedeliveryForgotten; }

}  // namespace uplink::robot
