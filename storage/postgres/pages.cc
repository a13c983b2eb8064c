#include "storage/postgres/pages.h"

#include <algorithm>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "schema/model/ids.h"
#include "storage/origin.h"

namespace uplink::storage::postgres {
namespace {

/// A statement that grows with the parameters it needs.
class Builder final {
 public:
  explicit Builder(std::string_view sql) { call_.sql = sql; }

  void Text(std::string_view sql) { call_.sql += sql; }
  /// Adds a parameter; how the statement names it.
  template <typename Value>
  std::string Add(Value&& value, std::string_view type) {
    call_.parameters.Add(std::forward<Value>(value));
    return "$" + std::to_string(++count_) + "::" + std::string(type);
  }
  OwnedStoreCall Take() { return std::move(call_); }

 private:
  OwnedStoreCall call_;
  int count_ = 0;
};

void AddCondition(Builder& builder, const ListFilter::Condition& condition) {
  builder.Text(" AND ");
  const std::size_t mark = condition.sql.find('?');
  builder.Text(condition.sql.substr(0, mark));
  if (mark == std::string_view::npos) return;
  if (const auto* number = std::get_if<std::int64_t>(&condition.value)) {
    builder.Text(builder.Add(*number, "bigint"));
  } else if (const auto* text = std::get_if<std::string_view>(&condition.value)) {
    builder.Text(builder.Add(*text, "text"));
  }
  builder.Text(condition.sql.substr(mark + 1));
}

/// What the statement for a page is made of.
struct Select {
  const ListShape& shape;
  const HistoryQuery& query;
  const ListFilter& filter;
  const std::optional<PagePosition>& start;
  std::int64_t rows_max = 0;
};

std::string AddNames(Builder& builder, const std::vector<std::string_view>& names) {
  Array list(Type::kText);
  for (const std::string_view name : names) list.Text(name);
  return builder.Add(std::move(list), "text[]");
}

/// What the column holds: one of these; no name: anything.
struct Holds {
  std::string_view column;
  std::vector<std::string_view> names{};
  /// SQL that stands for one of them in turn; empty: the names stand there themselves.
  std::string_view each{};
};

void AddHolds(Builder& builder, const Holds& holds) {
  if (holds.names.empty()) return;
  builder.Text(" AND " + std::string(holds.column) + " = ");
  if (!holds.each.empty()) {
    builder.Text(holds.each);
  } else if (holds.names.size() == 1) {
    builder.Text(builder.Add(holds.names.front(), "text"));
  } else {
    builder.Text("ANY (" + AddNames(builder, holds.names) + ")");
  }
}

/// The rows of a list, in its order.
void AddSelect(Builder& builder, const Select& of, const Holds& ruri, const Holds& fleet) {
  const std::string time(of.shape.time_column);
  const bool newest = of.query.order == ListOrder::kNewestFirst;
  builder.Text(SelectSql(of.shape, "uplinkd.").view());
  builder.Text(" WHERE TRUE");
  AddHolds(builder, ruri);
  AddHolds(builder, fleet);
  if (of.query.robots_alone && of.shape.of_robots())
    builder.Text(" AND " + std::string(kOfARobotSql));
  if (of.query.from) {
    builder.Text(" AND " + time + " >= " + builder.Add(*of.query.from, "timestamptz"));
  }
  if (of.query.to) {
    builder.Text(" AND " + time + " <= " + builder.Add(*of.query.to, "timestamptz"));
  }
  if (of.start) {
    const std::string at = builder.Add(of.start->at, "timestamptz");
    // A forged token may hold what no column does; it then means the largest.
    const std::uint64_t entry = std::min(of.start->entry, std::uint64_t{model::kSeqMax});
    builder.Text(" AND (" + time + ", entry) " + (newest ? "<" : ">") + " (" + at + ", " +
                 builder.Add(entry, "bigint") + ")");
    // Says once more what the pair says: this lets whole days be left out.
    builder.Text(" AND " + time + (newest ? " <= " : " >= ") + at);
  }
  for (const ListFilter::Condition& condition : of.filter.conditions) {
    AddCondition(builder, condition);
  }
  const std::string direction = newest ? " DESC" : "";
  builder.Text(" ORDER BY " + time + direction + ", entry" + direction + " LIMIT " +
               builder.Add(of.rows_max, "bigint"));
}

}  // namespace

OwnedStoreCall PageCall(const ListShape& shape, const HistoryQuery& query, const ListFilter& filter,
                        const std::optional<PagePosition>& start, std::int64_t rows_max) {
  const Select of{shape, query, filter, start, rows_max};
  Holds ruri{.column = shape.ruri_column, .names = Distinct(query.ruris)};
  Holds fleet{.column = "fleet", .names = Distinct(query.fleets)};
  // A search in the index for each robot, or else for each fleet unless another index leaves fewer
  // rows: by a list of them the database would sort all their rows.
  Holds* merged = nullptr;
  if (ruri.names.size() > 1) merged = &ruri;
  if (ruri.names.empty() && fleet.names.size() > 1 && !filter.leads) merged = &fleet;
  if (merged == nullptr) {
    Builder builder("");
    AddSelect(builder, of, ruri, fleet);
    return builder.Take();
  }
  Builder builder("SELECT r.* FROM unnest(");
  builder.Text(AddNames(builder, merged->names) + ") AS u (name) CROSS JOIN LATERAL (");
  merged->each = "u.name";
  AddSelect(builder, of, ruri, fleet);
  const std::string direction = query.order == ListOrder::kNewestFirst ? " DESC" : "";
  builder.Text(") AS r ORDER BY r." + std::string(shape.time_column) + direction + ", r.entry" +
               direction + " LIMIT " + builder.Add(rows_max, "bigint"));
  return builder.Take();
}

}  // namespace uplink::storage::postgres
