#pragma once

#include <string>
#include <string_view>
#include <type_traits>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "storage/reader.h"
#include "storage/sqlite/pages.h"
#include "storage/sqlite/tables/lists.h"

// Lists of a table's rows: what is read, and what is made of it, is the table's description.
namespace uplink::storage::sqlite {

template <PageKind kList>
struct List {
  static constexpr const auto& kTable = ListTable<kList>::kTable;
  using Row = typename std::remove_cvref_t<decltype(kTable)>::ListRow;

  static constexpr SqlText kColumns = ListedColumns(kTable);
  static constexpr ListShape kShape = {kList, kTable.name, kColumns.view(),
                                       kTable.listed.time_column};

  /// Errors: kInternal for a row that no program of ours wrote.
  static absl::StatusOr<Row> Read(const Rows& rows) {
    Row made;
    made.robot = {std::string(rows.Bytes(kRuriColumn)), std::string(rows.Bytes(kFleetColumn))};
    if (kTable.listed.read_time != nullptr) {
      kTable.listed.read_time(FromUnixMs(rows.Int(kTimeColumn)), made);
    }
    absl::Status status;
    int number = kFirstOwnColumn;
    for (const auto& column : kTable.columns) {
      if (column.read) (*column.read)(Cell(rows, number++, status), made);
    }
    if (!status.ok()) return status;
    return made;
  }
};

// What a query asks beyond which rows. `open_if` is the table's (Listed).
[[nodiscard]] ListFilter FilterOf(const HistoryQuery& query, std::string_view open_if);
[[nodiscard]] ListFilter FilterOf(const MissionsQuery& query, std::string_view open_if);
[[nodiscard]] ListFilter FilterOf(const PresentQuery& query, std::string_view open_if);
[[nodiscard]] ListFilter FilterOf(const ScopeUpdatesQuery& query, std::string_view open_if);
[[nodiscard]] ListFilter FilterOf(const QuarantineQuery& query, std::string_view open_if);

/// Reads one page of a list.
template <PageKind kList, typename Query>
absl::StatusOr<Page<typename List<kList>::Row>> ReadList(Database& database, const Query& query) {
  return ReadPage<typename List<kList>::Row>(database, List<kList>::kShape, RowsOf(query),
                                             List<kList>::Read,
                                             FilterOf(query, List<kList>::kTable.listed.open_if));
}

}  // namespace uplink::storage::sqlite
