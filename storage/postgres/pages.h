#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include <absl/status/statusor.h>

#include "storage/page_token.h"
#include "storage/postgres/link/connection.h"
#include "storage/postgres/link/result.h"
#include "storage/postgres/tables/columns.h"
#include "storage/reader.h"
#include "storage/tables/lists.h"

namespace uplink::storage::postgres {

/// Rows that a page asks for first; what follows is sized by their bytes, so that a page of large
/// payloads is not read whole to be thrown away.
inline constexpr std::int64_t kFirstChunkRows = 128;

/// Rows to ask for next, when so many had so many bytes: as fit into the rest of a page, and one.
[[nodiscard]] inline std::int64_t NextChunkRows(std::size_t rows, std::size_t bytes) {
  const std::size_t each = bytes / rows + 1;
  const std::size_t left = bytes < kPageBytesMax ? kPageBytesMax - bytes : 0;
  return static_cast<std::int64_t>(left / each) + 1;
}

/// A statement with its parameters. The text is the owner's, unlike a StoreCall's.
struct OwnedStoreCall {
  std::string sql;
  Parameters parameters;
};

/// The statement for at most `rows_max` rows of a list, from `start` on. Of several robots or
/// fleets it merges at most so many rows of each.
[[nodiscard]] OwnedStoreCall PageCall(const ListShape& shape, const HistoryQuery& query,
                                      const ListFilter& filter,
                                      const std::optional<PagePosition>& start,
                                      std::int64_t rows_max);

/// Reads one page; `read` makes a Row of a row of the result. The page ends early once its texts
/// have passed kPageBytesMax.
template <typename Row, typename Read>
absl::StatusOr<Page<Row>> ReadPage(Connection& connection, const ListShape& shape,
                                   const HistoryQuery& query, const Read& read,
                                   const ListFilter& filter = {}) {
  absl::StatusOr<std::optional<PagePosition>> start = PageStart(shape.kind, query);
  if (!start.ok()) return start.status();
  Page<Row> page;
  std::optional<PagePosition> last = *start;
  std::size_t bytes = 0;
  std::int64_t chunk = kFirstChunkRows;
  while (true) {
    // One row more than asked for tells whether another page follows.
    const auto wanted =
        std::int64_t{query.page_size} + 1 - static_cast<std::int64_t>(page.rows.size());
    const std::int64_t asked = std::min(wanted, chunk);
    OwnedStoreCall call = PageCall(shape, query, filter, last, asked);
    const auto rows = connection.RunOne({call.sql, std::move(call.parameters)}, "read");
    if (!rows.ok()) return rows.status();
    for (const ResultRow& row : *rows) {
      if (page.rows.size() == query.page_size || bytes >= kPageBytesMax) {
        page.next_token = EncodePageToken(shape.kind, query.order, *last);
        return page;
      }
      bytes += row.TextBytes();
      page.rows.push_back(read(row));
      last = PagePosition{row.Time(kTimeColumn), static_cast<std::uint64_t>(row.Int(kEntryColumn))};
      page.positions.push_back(*last);
    }
    if (rows->rows() < asked) return page;
    chunk = NextChunkRows(page.rows.size(), bytes);
  }
}

/// A row of the list.
template <PageKind kList>
typename List<kList>::Row ReadRow(const ResultRow& row) {
  return List<kList>::Read(
      [&](int index, ColumnType type) { return ReadColumn(row, index, type); });
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
