#pragma once

#include <vector>

#include "metrics/ledger.h"
#include "server/journal/gathered_batch.h"
#include "server/journal/holds.h"
#include "server/loop/wake.h"
#include "storage/outcome.h"

namespace uplink::journal {

/// Tells each robot the outcomes of its records and gaps in `batch`, and fences robots that another
/// process owns, and drones that another one claimed. `outcomes` are the store's, one per record.
/// Entries that became void meanwhile are not reported. Counts go to `ledger`.
///
/// Returns the streams to wake, last those that wait only for the commit. The caller wakes them
/// once it has let go of the batch.
/// Thread: the writer alone, with no lock held.
[[nodiscard]] std::vector<loop::StreamRef> TellOutcomes(const GatheredBatch& batch,
                                                        std::vector<storage::Outcome> outcomes,
                                                        Holds& holds, metrics::Ledger& ledger);

}  // namespace uplink::journal
