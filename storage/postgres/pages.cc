#include "storage/postgres/pages.h"

#include <algorithm>
#include <string>
#include <utility>

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
  std::string Add(const Value& value, std::string_view type) {
    call_.parameters.Add(value);
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

}  // namespace

OwnedStoreCall PageCall(const ListShape& shape, const HistoryQuery& query, const ListFilter& filter,
                        const std::optional<PagePosition>& start, std::int64_t rows_max) {
  const std::string time(shape.time_column);
  Builder builder(SelectSql(shape, "uplinkd.").view());
  builder.Text(" WHERE TRUE");
  if (!query.ruri.empty()) builder.Text(" AND ruri = " + builder.Add(query.ruri, "text"));
  if (!query.fleet.empty()) builder.Text(" AND fleet = " + builder.Add(query.fleet, "text"));
  if (query.from) builder.Text(" AND " + time + " >= " + builder.Add(*query.from, "timestamptz"));
  if (query.to) builder.Text(" AND " + time + " <= " + builder.Add(*query.to, "timestamptz"));
  if (start) {
    const std::string at = builder.Add(start->at, "timestamptz");
    // A forged token may hold what no column does; it then means the largest.
    const std::uint64_t entry = std::min(start->entry, std::uint64_t{model::kSeqMax});
    builder.Text(" AND (" + time + ", entry) < (" + at + ", " + builder.Add(entry, "bigint") + ")");
    // Says once more what the pair says: this lets whole days be left out.
    builder.Text(" AND " + time + " <= " + at);
  }
  for (const ListFilter::Condition& condition : filter.conditions) {
    AddCondition(builder, condition);
  }
  builder.Text(" ORDER BY " + time + " DESC, entry DESC LIMIT " + builder.Add(rows_max, "bigint"));
  return builder.Take();
}

}  // namespace uplink::storage::postgres
