// Linked into a program with the sessions' sources in their mutable form: acks go out before the
// commit.
#include "server/session/mutation.h"

namespace uplink::session {

bool Planted(Mutation mutation) { return mutation == Mutation::kAckBeforeCommit; }

}  // namespace uplink::session
