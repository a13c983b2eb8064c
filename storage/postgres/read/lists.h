#pragma once

#include <string>
#include <string_view>
#include <type_traits>

#include <absl/status/statusor.h>

#include "storage/postgres/link/result.h"
#include "storage/postgres/read/pages.h"
#include "storage/postgres/tables/lists.h"
#include "storage/reader.h"

// Lists of a table's rows: what is read, and what is made of it, is the table's description.
namespace uplink::storage::postgres {

/// The texts are constants.
template <PageKind kList>
struct List {
  static constexpr const auto& kTable = ListTable<kList>::kTable;
  using Row = typename std::remove_cvref_t<decltype(kTable)>::ListRow;

  static constexpr SqlText kColumns = ListedColumns(kTable);
  static constexpr ListShape kShape = {kList, kTable.name, kColumns.view(),
                                       kTable.listed.time_column};

  static Row Read(const Result& rows, int row) {
    Row made;
    made.robot = {std::string(rows.Bytes(row, kRuriColumn)),
                  std::string(rows.Bytes(row, kFleetColumn))};
    if (kTable.listed.read_time != nullptr) {
      kTable.listed.read_time(rows.Time(row, kTimeColumn), made);
    }
    int number = kFirstOwnColumn;
    for (const auto& column : kTable.columns) {
      if (column.read) (*column.read)(Cell(rows, row, number++), made);
    }
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
absl::StatusOr<Page<typename List<kList>::Row>> ReadList(Connection& connection,
                                                         const Query& query) {
  return ReadPage<typename List<kList>::Row>(connection, List<kList>::kShape, RowsOf(query),
                                             List<kList>::Read,
                                             FilterOf(query, List<kList>::kTable.listed.open_if));
}

}  // namespace uplink::storage::postgres
