#include "tests/simulation/planted.h"

namespace uplink::robot {
namespace {

// The one global of the simulation: the planted fault of this process's runs.
Mutation planted = Mutation::kNone;

}  // namespace

void Plant(Mutation mutation) { planted = mutation; }

bool Planted(Mutation mutation) { return planted == mutation; }

}  // namespace uplink::robot
