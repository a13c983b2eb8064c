#pragma once

#include <absl/status/status.h>

#include "schema/model/rejection.h"
#include "storage/commit_record.h"
#include "storage/sqlite/entry_number.h"
#include "storage/sqlite/table_writers.h"

namespace uplink::storage::sqlite {

/// Writes the quarantine row of a record. Leaves out the payload, then the texts, where the
/// database refuses a row with them.
///
/// Errors: those of errors.h; kInvalidArgument if not even a bare row is taken. Thread: confined to
/// the thread of the database.
[[nodiscard]] absl::Status WriteQuarantineRow(TableWriters& rows, const CommitRecord& record,
                                              const model::Rejection& rejection, EntryNumber entry);

}  // namespace uplink::storage::sqlite
