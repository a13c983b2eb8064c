#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>

#include "storage/lists.h"
#include "storage/reader.h"
#include "storage/tables/audit.h"
#include "storage/tables/connections.h"
#include "storage/tables/latest.h"
#include "storage/tables/missions.h"
#include "storage/tables/present.h"
#include "storage/tables/reports.h"
#include "storage/tables/samples.h"
#include "storage/tables/set_aside.h"

// Which table each list reads, how its rows are read, and what a query leaves of them.
namespace uplink::storage {

/// One list as it lies in the database.
struct ListShape {
  PageKind kind;
  std::string_view table;
  /// The columns of a row, after its time, entry, ruri and fleet.
  std::string_view columns;
  /// What the list is ordered by, newest first; entry breaks ties.
  std::string_view time_column;
  /// What a row is about: a robot, unless its name is another.
  std::string_view ruri_column = "ruri";

  [[nodiscard]] constexpr bool of_robots() const { return ruri_column == "ruri"; }
};

/// Columns that every row of a list begins with; those of ListShape follow.
inline constexpr int kTimeColumn = 0;
inline constexpr int kEntryColumn = 1;
inline constexpr int kRuriColumn = 2;
inline constexpr int kFleetColumn = 3;
inline constexpr int kFirstOwnColumn = 4;

/// Reads a list's rows, up to the table's name. `schema`: what its name begins with.
[[nodiscard]] constexpr SqlText SelectSql(const ListShape& shape, std::string_view schema) {
  return {"SELECT ",     shape.time_column, ", entry, ", shape.ruri_column, ", fleet, ",
          shape.columns, " FROM ",          schema,      shape.table};
}

template <typename Out, const auto& kOf>
struct ListOf {
  static constexpr const auto& kTable = kOf;
  using Row = Out;
  using In = typename std::remove_cvref_t<decltype(kOf)>::In;
  static_assert(std::is_same_v<typename std::remove_cvref_t<decltype(kOf)>::ListRow, Row>);

  static constexpr SqlText kColumns = ListedColumns(kOf);

  /// `cells(column, type)` is the ColumnValue of a row that begins as said above.
  template <typename Cells>
  static Row Read(const Cells& cells) {
    Row row;
    Take(cells(kRuriColumn, ColumnType::kText), row.robot.ruri);
    Take(cells(kFleetColumn, ColumnType::kText), row.robot.fleet);
    if (kOf.listed.read_time != nullptr) {
      kOf.listed.read_time(std::get<SystemTime>(cells(kTimeColumn, ColumnType::kTime)), row);
    }
    int number = kFirstOwnColumn;
    for (const auto& column : kOf.columns) {
      if (column.take) (*column.take)(cells(number++, column.type), row);
    }
    return row;
  }
};

template <PageKind kList>
struct List;
#define UPLINK_LIST(Name, number, RowOfList, Query, retained)                             \
  template <>                                                                             \
  struct List<PageKind::k##Name> : ListOf<RowOfList, k##Name##Table> {                    \
    static constexpr ListShape kShape = {PageKind::k##Name, kTable.name, kColumns.view(), \
                                         kTable.listed.time_column};                      \
  };
UPLINK_LISTS(UPLINK_LIST)
#undef UPLINK_LIST

/// Its rows are no robot's: they have a target instead.
template <>
struct List<PageKind::kAudit> {
  static constexpr const auto& kTable = kAuditTable;
  using Row = AuditRow;
  static constexpr SqlText kColumns = ListedColumns(kAuditTable);
  static constexpr ListShape kShape = {PageKind::kAudit, kTable.name, kColumns.view(),
                                       kTable.listed.time_column, "target"};

  template <typename Cells>
  static Row Read(const Cells& cells) {
    Row row;
    Take(cells(kRuriColumn, ColumnType::kText), row.target);
    Take(cells(kFleetColumn, ColumnType::kText), row.fleet);
    kTable.listed.read_time(std::get<SystemTime>(cells(kTimeColumn, ColumnType::kTime)), row);
    int number = kFirstOwnColumn;
    for (const auto& column : kTable.columns) {
      (*column.take)(cells(number++, column.type), row);
    }
    return row;
  }
};

/// The history to which reports of a kind go as they came; nothing if there is none.
template <typename Body>
consteval std::optional<PageKind> HistoryOf() {
  std::optional<PageKind> history;
  ForEachList([&history]<PageKind kList>() {
    if constexpr (std::is_same_v<typename List<kList>::In, Report<Body>>) history = kList;
  });
  return history;
}

/// What a query restricts beyond HistoryQuery. The texts must outlive the read.
struct ListFilter {
  struct Condition {
    /// SQL, with `?` for the value if there is one.
    std::string_view sql;
    std::variant<std::monostate, std::int64_t, std::string_view> value = {};
    /// Another index than the one of the column that begins the condition is the better one.
    bool by_other_index = false;
  };
  std::vector<Condition> conditions;
  /// The index of one of their columns is better than the fleet's.
  bool leads = false;
};

// What a query asks beyond which rows. `open_column` is the table's (Listed).
[[nodiscard]] ListFilter FilterOf(const HistoryQuery& query, std::string_view open_column);
[[nodiscard]] ListFilter FilterOf(const FaultsQuery& query, std::string_view open_column);
[[nodiscard]] ListFilter FilterOf(const EventsQuery& query, std::string_view open_column);
[[nodiscard]] ListFilter FilterOf(const MessagesQuery& query, std::string_view open_column);
[[nodiscard]] ListFilter FilterOf(const MissionsQuery& query, std::string_view open_column);
[[nodiscard]] ListFilter FilterOf(const PresentQuery& query, std::string_view open_column);
[[nodiscard]] ListFilter FilterOf(const ScopeUpdatesQuery& query, std::string_view open_column);
[[nodiscard]] ListFilter FilterOf(const OperatorRequestsQuery& query, std::string_view open_column);
[[nodiscard]] ListFilter FilterOf(const QuarantineQuery& query, std::string_view open_column);
[[nodiscard]] ListFilter FilterOf(const ConnectionsQuery& query, std::string_view open_column);
[[nodiscard]] ListFilter FilterOf(const AuditQuery& query, std::string_view open_column);

}  // namespace uplink::storage
