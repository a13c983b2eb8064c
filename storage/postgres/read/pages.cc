#include "storage/postgres/read/pages.h"

#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "schema/model/ids.h"

namespace uplink::storage::postgres {
namespace {

/// A statement that grows with the parameters it needs.
class Builder final {
 public:
  void Text(std::string_view sql) { call_.sql += sql; }
  /// The number of the parameter that comes next, as SQL has it.
  std::string Next() { return "$" + std::to_string(++count_); }
  Parameters& parameters() { return call_.parameters; }
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
    builder.Text(builder.Next() + "::bigint");
    builder.parameters().Int8(*number);
  } else if (const auto* text = std::get_if<std::string_view>(&condition.value)) {
    builder.Text(builder.Next() + "::text");
    builder.parameters().Text(*text);
  }
  builder.Text(condition.sql.substr(mark + 1));
}

}  // namespace

OwnedStoreCall PageCall(const ListShape& shape, const HistoryQuery& query, const ListFilter& filter,
                        const std::optional<PagePosition>& start, std::int64_t rows_max) {
  const std::string time(shape.time_column);
  Builder builder;
  builder.Text("SELECT " + time + ", entry, ruri, fleet, ");
  builder.Text(shape.columns);
  builder.Text(" FROM uplinkd.");
  builder.Text(shape.table);
  builder.Text(" WHERE TRUE");
  if (!query.ruri.empty()) {
    builder.Text(" AND ruri = " + builder.Next() + "::text");
    builder.parameters().Text(query.ruri);
  }
  if (!query.fleet.empty()) {
    builder.Text(" AND fleet = " + builder.Next() + "::text");
    builder.parameters().Text(query.fleet);
  }
  if (query.from) {
    builder.Text(" AND " + time + " >= " + builder.Next() + "::timestamptz");
    builder.parameters().Time(*query.from);
  }
  if (query.to) {
    builder.Text(" AND " + time + " <= " + builder.Next() + "::timestamptz");
    builder.parameters().Time(*query.to);
  }
  if (start) {
    const std::string at = builder.Next() + "::timestamptz";
    builder.Text(" AND (" + time + ", entry) < (" + at + ", " + builder.Next() + "::bigint)");
    builder.parameters().Time(start->at);
    // A forged token may hold what no column does; it then means the largest.
    builder.parameters().Int8(
        static_cast<std::int64_t>(std::min(start->entry, std::uint64_t{model::kSeqMax})));
    // Says once more what the pair says: this lets whole days be left out.
    builder.Text(" AND " + time + " <= " + at);
  }
  for (const ListFilter::Condition& condition : filter.conditions) {
    AddCondition(builder, condition);
  }
  builder.Text(" ORDER BY " + time + " DESC, entry DESC LIMIT " + builder.Next() + "::bigint");
  builder.parameters().Int8(rows_max);
  return builder.Take();
}

absl::StatusOr<Result> RunOne(Connection& connection, OwnedStoreCall call) {
  std::vector<StoreCall> calls;
  calls.push_back({call.sql, std::move(call.parameters)});
  auto results = connection.Run(calls, "read");
  if (!results.ok()) return results.status();
  return std::move(results->front());
}

}  // namespace uplink::storage::postgres
