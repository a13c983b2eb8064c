#pragma once

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "storage/reader.h"
#include "storage/sqlite/columns.h"
#include "storage/sqlite/pages.h"
#include "storage/tables/lists.h"

namespace uplink::storage::sqlite {

/// The list's row that is read. Errors: kInternal for one that no program of ours wrote.
template <PageKind kList>
absl::StatusOr<typename List<kList>::Row> ReadRow(const Rows& rows) {
  absl::Status status;
  auto row = List<kList>::Read(
      [&](int index, ColumnType type) { return ReadColumn(rows, index, type, status); });
  if (!status.ok()) return status;
  return row;
}

/// Reads one page of a list.
template <PageKind kList, typename Query>
absl::StatusOr<Page<typename List<kList>::Row>> ReadList(Database& database, const Query& query) {
  return ReadPage<typename List<kList>::Row>(
      database, List<kList>::kShape, RowsOf(query), ReadRow<kList>,
      FilterOf(query, List<kList>::kTable.listed.open_column));
}

}  // namespace uplink::storage::sqlite
