#pragma once

#include "storage/identity.h"
#include "storage/postgres/write/known.h"
#include "storage/postgres/write/reads.h"

namespace uplink::storage::postgres {

/// Reads the claims of the slice's drones, and what is remembered of the samples and requests that
/// it names. Once the robots' rows are locked, and are known.
void ReadDrones(const Slice& slice, const ProcessId& process, KnownRows& known, Reads& reads);

}  // namespace uplink::storage::postgres
