#pragma once

#include <absl/status/status.h>

#include "storage/sqlite/entry_number.h"
#include "storage/types.h"

namespace uplink::storage::sqlite {

struct Tables;

/// Writes the changes of presence of a batch that its session's cursor has not passed, and moves
/// the cursor. Of the processes' sessions, the least recently used over their bound go.
///
/// Errors: those of the tables. Thread: confined to the thread of the database.
[[nodiscard]] absl::Status WritePresence(Tables& tables, const Batch& batch,
                                         EntryNumber& next_entry);

}  // namespace uplink::storage::sqlite
