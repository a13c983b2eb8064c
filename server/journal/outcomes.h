#pragma once

#include <vector>

#include "metrics/ledger.h"
#include "server/journal/gathered_batch.h"
#include "server/journal/holds.h"
#include "server/loop/wake.h"
#include "storage/outcome.h"

namespace uplink::journal {

/// Tells each robot what became of its records and gaps in `batch`, and fences those that another
/// process owns, or drones that another one claimed. `outcomes` are the store's, one per record.
/// What became void meanwhile is not told. Counts go to `ledger`.
///
/// Returns the streams to wake, those last that wait for the commit alone: the caller does so once
/// it has let go of the batch.
/// Thread: the writer alone, with no lock held.
[[nodiscard]] std::vector<loop::StreamRef> TellOutcomes(const GatheredBatch& batch,
                                                        std::vector<storage::Outcome> outcomes,
                                                        Holds& holds, metrics::Ledger& ledger);

}  // namespace uplink::journal
