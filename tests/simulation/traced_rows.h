#pragma once

#include "storage/reader.h"
#include "tests/simulation/trace.h"

namespace uplink::simulation {

/// Writes every row that a run of the simulation can leave behind into the trace, in the reader's
/// order: robots, faults, events, quarantine, gaps and changes of presence.
void TraceRows(storage::Reader& reader, Trace& trace);

}  // namespace uplink::simulation
