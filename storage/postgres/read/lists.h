#pragma once

#include <type_traits>

#include <absl/status/statusor.h>

#include "storage/postgres/link/result.h"
#include "storage/postgres/read/pages.h"
#include "storage/postgres/tables/table.h"
#include "storage/reader.h"

// Lists of a table's rows: what is read, and what is made of it, is the table's description.
namespace uplink::storage::postgres {

/// `kTable` is a constant, so that the texts are constants too.
template <const auto& kTable>
struct List {
  using Row = typename std::remove_cvref_t<decltype(kTable)>::ListRow;

  static constexpr SqlText kColumns = ListedColumns(kTable);
  static constexpr ListShape kShape = {kTable.listed.kind, kTable.name, kColumns.view(),
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
      if (column.read != nullptr) column.read(Cell(rows, row, number++), made);
    }
    return made;
  }
};

/// Reads one page of a table.
template <const auto& kTable>
absl::StatusOr<Page<typename List<kTable>::Row>> ReadList(Connection& connection,
                                                          const HistoryQuery& query,
                                                          const ListFilter& filter = {}) {
  return ReadPage<typename List<kTable>::Row>(connection, List<kTable>::kShape, query,
                                              List<kTable>::Read, filter);
}

[[nodiscard]] ListFilter FilterOf(const MissionsQuery& query, bool open);
[[nodiscard]] ListFilter FilterOf(const PresentQuery& query);

}  // namespace uplink::storage::postgres
