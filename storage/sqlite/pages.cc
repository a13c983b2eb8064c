#include "storage/sqlite/pages.h"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

namespace uplink::storage::sqlite {
namespace {

/// What the statement for the rows of one robot, or of all, is made of.
struct Select {
  const ListShape& shape;
  const HistoryQuery& query;
  const ListFilter& filter;
};

/// A parameter by its number: the parts of a statement for several robots share all but theirs.
std::string Parameter(int number) { return "?" + std::to_string(number); }

/// The rows, without their order. `ruri` is the number of the robot's parameter, and `next` that of
/// the first one behind the robots'.
std::string SelectOne(const Select& of, std::optional<int> ruri, int next) {
  const std::string time(of.shape.time_column);
  const bool newest = of.query.order == ListOrder::kNewestFirst;
  std::string sql(SelectSql(of.shape, "").view());
  sql += " WHERE TRUE";
  if (ruri) sql += " AND ruri = " + Parameter(*ruri);
  if (!of.query.fleet.empty()) {
    // The plus keeps the column's own index out, where another one leaves fewer rows.
    sql += ruri || of.filter.leads ? " AND +fleet = " : " AND fleet = ";
    sql += Parameter(next++);
  }
  if (of.query.from) sql += " AND " + time + " >= " + Parameter(next++);
  if (of.query.to) sql += " AND " + time + " <= " + Parameter(next++);
  if (!of.query.page_token.empty()) {
    sql += " AND (" + time + ", entry) " + (newest ? "<" : ">") + " (" + Parameter(next) + ", " +
           Parameter(next + 1) + ")";
    next += 2;
  }
  for (const ListFilter::Condition& condition : of.filter.conditions) {
    sql += condition.by_other_index ? " AND +" : " AND ";
    const std::size_t mark = condition.sql.find('?');
    sql += condition.sql.substr(0, mark);
    if (mark == std::string_view::npos) continue;
    sql += Parameter(next++);
    sql += condition.sql.substr(mark + 1);
  }
  return sql;
}

}  // namespace

std::string PageSql(const ListShape& shape, const HistoryQuery& query, const ListFilter& filter) {
  const Select of{shape, query, filter};
  const int ruris = static_cast<int>(DistinctRuris(query).size());
  std::string sql = SelectOne(of, ruris == 0 ? std::nullopt : std::optional(1), ruris + 1);
  for (int ruri = 2; ruri <= ruris; ++ruri) {
    sql += " UNION ALL " + SelectOne(of, ruri, ruris + 1);
  }
  const std::string direction = query.order == ListOrder::kNewestFirst ? " DESC" : "";
  // Time and entry: what a list is ordered by stands first.
  return sql + " ORDER BY 1" + direction + ", 2" + direction + " LIMIT ?";
}

void BindPage(Statement& statement, const HistoryQuery& query, const ListFilter& filter,
              const std::optional<PagePosition>& start, std::int64_t rows) {
  int index = 0;
  for (const std::string_view ruri : DistinctRuris(query)) statement.Bind(++index, ruri);
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
