#pragma once

#include <absl/status/status.h>

#include "storage/sqlite/statement.h"
#include "storage/tables/column.h"

// How the values of tables' columns lie in the file: times are Unix milliseconds, sessions are
// blobs.
namespace uplink::storage::sqlite {

/// Binds a value for one run of the statement, which it must outlive.
void BindColumn(Statement& statement, int index, ColumnType type, const ColumnValue& value);

/// A value of the present row, valid until the next one. `status` becomes an error for a value that
/// no program of ours wrote.
[[nodiscard]] ColumnValue ReadColumn(const Rows& rows, int index, ColumnType type,
                                     absl::Status& status);

}  // namespace uplink::storage::sqlite
