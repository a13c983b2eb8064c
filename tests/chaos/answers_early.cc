// Linked into a program with the calls of drones in their mutable form: a sample is answered when
// it was taken, before the commit.
#include "server/robot/mutation.h"

namespace uplink::robot {

bool Planted(Mutation mutation) { return mutation == Mutation::kSampleAnsweredEarly; }

}  // namespace uplink::robot
