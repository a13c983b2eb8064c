#pragma once

#include <absl/status/statusor.h>

#include "storage/postgres/link/result.h"
#include "storage/postgres/read/pages.h"
#include "storage/postgres/tables/columns.h"
#include "storage/reader.h"
#include "storage/tables/lists.h"

namespace uplink::storage::postgres {

/// A row of the list.
template <PageKind kList>
typename List<kList>::Row ReadRow(const Result& rows, int row) {
  return List<kList>::Read(
      [&](int index, ColumnType type) { return ReadColumn(rows, row, index, type); });
}

/// Reads one page of a list.
template <PageKind kList, typename Query>
absl::StatusOr<Page<typename List<kList>::Row>> ReadList(Connection& connection,
                                                         const Query& query) {
  return ReadPage<typename List<kList>::Row>(
      connection, List<kList>::kShape, RowsOf(query), ReadRow<kList>,
      FilterOf(query, List<kList>::kTable.listed.open_column));
}

}  // namespace uplink::storage::postgres
