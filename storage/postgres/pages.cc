#include "storage/postgres/pages.h"

#include <algorithm>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "schema/model/ids.h"

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

/// The rows of a list, in its order. `ruri` is SQL of the robot's; empty: of any.
struct Select {
  const ListShape& shape;
  const HistoryQuery& query;
  const ListFilter& filter;
  const std::optional<PagePosition>& start;
  std::int64_t rows_max = 0;
};

void AddSelect(Builder& builder, const Select& of, std::string_view ruri) {
  const std::string time(of.shape.time_column);
  const bool newest = of.query.order == ListOrder::kNewestFirst;
  builder.Text(SelectSql(of.shape, "uplinkd.").view());
  builder.Text(" WHERE TRUE");
  if (!ruri.empty()) builder.Text(" AND ruri = " + std::string(ruri));
  if (!of.query.fleet.empty()) {
    builder.Text(" AND fleet = " + builder.Add(of.query.fleet, "text"));
  }
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
  const std::vector<std::string_view> ruris = DistinctRuris(query);
  if (ruris.size() <= 1) {
    Builder builder("");
    const std::string ruri = ruris.empty() ? "" : builder.Add(ruris.front(), "text");
    AddSelect(builder, of, ruri);
    return builder.Take();
  }
  // A search in the index for each robot: by a list of robots the database would sort all their
  // rows.
  Array list(Type::kText);
  for (const std::string_view ruri : ruris) list.Text(ruri);
  Builder builder("SELECT r.* FROM unnest(");
  builder.Text(builder.Add(std::move(list), "text[]") + ") AS u (robot) CROSS JOIN LATERAL (");
  AddSelect(builder, of, "u.robot");
  const std::string direction = query.order == ListOrder::kNewestFirst ? " DESC" : "";
  builder.Text(") AS r ORDER BY r." + std::string(shape.time_column) + direction + ", r.entry" +
               direction + " LIMIT " + builder.Add(rows_max, "bigint"));
  return builder.Take();
}

}  // namespace uplink::storage::postgres
