#pragma once

#include <vector>

#include <absl/status/status.h>

#include "storage/batch.h"
#include "storage/decide.h"
#include "storage/outcome.h"
#include "storage/sqlite/entry_number.h"

namespace uplink::storage::sqlite {

struct Tables;

/// Writes the changes of presence of a batch that are new, and moves the cursor of their session.
/// Adds the outcome of each. Of the processes' sessions, the least recently used over their bound
/// go.
///
/// Errors: those of the tables. Thread: confined to the thread of the database.
[[nodiscard]] absl::Status WritePresence(Tables& tables, Decider& decider, const Batch& batch,
                                         EntryNumber& next_entry, std::vector<Outcome>& outcomes);

}  // namespace uplink::storage::sqlite
