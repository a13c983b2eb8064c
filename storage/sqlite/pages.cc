#include "storage/sqlite/pages.h"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "storage/origin.h"

namespace uplink::storage::sqlite {
namespace {

/// What the statement for the rows of one robot, of one fleet, or of all is made of.
struct Select {
  const ListShape& shape;
  const HistoryQuery& query;
  const ListFilter& filter;
  /// Each of the query's, once.
  std::vector<std::string_view> ruris;
  std::vector<std::string_view> fleets;

  Select(const ListShape& of_shape, const HistoryQuery& of_query, const ListFilter& of_filter)
      : shape(of_shape),
        query(of_query),
        filter(of_filter),
        ruris(Distinct(of_query.ruris)),
        fleets(Distinct(of_query.fleets)) {}

  /// Each fleet is searched for in its own index, unless another one leaves fewer rows.
  [[nodiscard]] bool by_fleet() const { return ruris.empty() && !fleets.empty() && !filter.leads; }
  /// How many searches are merged.
  [[nodiscard]] std::size_t parts() const {
    return std::max<std::size_t>(by_fleet() ? fleets.size() : ruris.size(), 1);
  }
};

/// A parameter by its number: the parts of a statement share all but their robot's or fleet's.
std::string Parameter(std::size_t number) { return "?" + std::to_string(number); }

/// Leaves rows of the query's fleets. Parameters are numbered from `next` on.
std::string FleetsSql(const Select& of, std::size_t part, std::size_t& next) {
  if (of.fleets.empty()) return "";
  const std::size_t first = next;
  next += of.fleets.size();
  if (of.by_fleet()) return " AND fleet = " + Parameter(first + part);
  // The plus keeps the column's own index out, where another one leaves fewer rows.
  std::string sql = " AND +fleet IN (" + Parameter(first);
  for (std::size_t number = first + 1; number < next; ++number) sql += ", " + Parameter(number);
  return sql + ")";
}

/// The rows of one part, without their order. The robots' parameters are the first ones.
std::string SelectOne(const Select& of, std::size_t part) {
  const std::string time(of.shape.time_column);
  const bool newest = of.query.order == ListOrder::kNewestFirst;
  std::string sql(SelectSql(of.shape, "").view());
  sql += " WHERE TRUE";
  if (!of.ruris.empty()) {
    sql.append(" AND ").append(of.shape.ruri_column).append(" = ").append(Parameter(1 + part));
  }
  std::size_t next = of.ruris.size() + 1;
  sql += FleetsSql(of, part, next);
  if (of.query.robots_alone && of.shape.of_robots()) sql += " AND " + std::string(kOfARobotSql);
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
  const Select of(shape, query, filter);
  std::string sql = SelectOne(of, 0);
  for (std::size_t part = 1; part < of.parts(); ++part) {
    sql += " UNION ALL " + SelectOne(of, part);
  }
  const std::string direction = query.order == ListOrder::kNewestFirst ? " DESC" : "";
  // Time and entry: what a list is ordered by stands first.
  return sql + " ORDER BY 1" + direction + ", 2" + direction + " LIMIT ?";
}

void BindPage(Statement& statement, const HistoryQuery& query, const ListFilter& filter,
              const std::optional<PagePosition>& start, std::int64_t rows) {
  int index = 0;
  for (const std::string_view ruri : Distinct(query.ruris)) statement.Bind(++index, ruri);
  for (const std::string_view fleet : Distinct(query.fleets)) statement.Bind(++index, fleet);
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
