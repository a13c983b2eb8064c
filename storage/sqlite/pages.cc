#include "storage/sqlite/pages.h"

#include <algorithm>
#include <string_view>
#include <variant>

namespace uplink::storage::sqlite {

std::string PageSql(const ListShape& shape, const HistoryQuery& query, const ListFilter& filter) {
  const std::string time(shape.time_column);
  std::string sql(SelectSql(shape, "").view());
  sql += " WHERE TRUE";
  if (!query.ruri.empty()) sql += " AND ruri = ?";
  if (!query.fleet.empty()) {
    // With a robot given, its own index is the narrower one: the plus keeps the other out.
    sql += query.ruri.empty() ? " AND fleet = ?" : " AND +fleet = ?";
  }
  if (query.from) sql += " AND " + time + " >= ?";
  if (query.to) sql += " AND " + time + " <= ?";
  if (!query.page_token.empty()) sql += " AND (" + time + ", entry) < (?, ?)";
  for (const ListFilter::Condition& condition : filter.conditions) {
    // The plus keeps the column's own index out.
    sql.append(condition.by_other_index ? " AND +" : " AND ").append(condition.sql);
  }
  sql += " ORDER BY " + time + " DESC, entry DESC LIMIT ?";
  return sql;
}

void BindPage(Statement& statement, const HistoryQuery& query, const ListFilter& filter,
              const std::optional<PagePosition>& start, std::int64_t rows) {
  int index = 0;
  if (!query.ruri.empty()) statement.Bind(++index, std::string_view(query.ruri));
  if (!query.fleet.empty()) statement.Bind(++index, std::string_view(query.fleet));
  if (query.from) statement.Bind(++index, UnixMs(*query.from));
  if (query.to) statement.Bind(++index, UnixMs(*query.to));
  if (start) {
    statement.Bind(++index, UnixMs(start->at));
    // A forged token may hold what no column does; it then means the largest.
    statement.Bind(++index, std::min(start->entry, std::uint64_t{model::kSeqMax}));
  }
  for (const ListFilter::Condition& condition : filter.conditions) {
    if (const auto* number = std::get_if<std::int64_t>(&condition.value)) {
      statement.Bind(++index, *number);
    } else if (const auto* text = std::get_if<std::string_view>(&condition.value)) {
      statement.Bind(++index, *text);
    }
  }
  statement.Bind(++index, rows);
}

}  // namespace uplink::storage::sqlite
