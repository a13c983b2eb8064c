#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include <absl/status/statusor.h>

#include "storage/page_token.h"
#include "storage/reader.h"
#include "storage/sqlite/columns.h"
#include "storage/sqlite/database.h"
#include "storage/tables/lists.h"

namespace uplink::storage::sqlite {

/// The statement for a page: a text by what the query restricts. Of several robots or fleets it
/// merges their rows, each read in the order of an index, until the page is full.
[[nodiscard]] std::string PageSql(const ListShape& shape, const HistoryQuery& query,
                                  const ListFilter& filter = {});

/// Binds the query to PageSql's statement. `rows` is how many to read at most.
void BindPage(Statement& statement, const HistoryQuery& query, const ListFilter& filter,
              const std::optional<PagePosition>& start, std::int64_t rows);

/// Reads one page; `read` makes a StatusOr<Row> of the present row. The page ends early once its
/// texts have passed kPageBytesMax.
template <typename Row, typename Read>
absl::StatusOr<Page<Row>> ReadPage(Database& database, const ListShape& shape,
                                   const HistoryQuery& query, const Read& read,
                                   const ListFilter& filter = {}) {
  const absl::StatusOr<std::optional<PagePosition>> start = PageStart(shape.kind, query);
  if (!start.ok()) return start.status();
  auto statement = database.Prepare(PageSql(shape, query, filter));
  if (!statement.ok()) return statement.status();
  // One row more than asked for tells whether another page follows.
  BindPage(**statement, query, filter, *start, std::int64_t{query.page_size} + 1);
  Rows rows = (*statement)->Select();
  Page<Row> page;
  PagePosition last;
  std::size_t bytes = 0;
  while (true) {
    const absl::StatusOr<bool> found = rows.Next();
    if (!found.ok()) return found.status();
    if (!*found) return page;
    if (page.rows.size() == query.page_size || bytes >= kPageBytesMax) {
      page.next_token = EncodePageToken(shape.kind, query.order, last);
      return page;
    }
    bytes += rows.TextBytes();
    absl::StatusOr<Row> row = read(rows);
    if (!row.ok()) return row.status();
    page.rows.push_back(*std::move(row));
    last = {FromUnixMs(rows.Int(kTimeColumn)), static_cast<std::uint64_t>(rows.Int(kEntryColumn))};
    page.positions.push_back(last);
  }
}

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
