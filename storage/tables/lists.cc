#include "storage/tables/lists.h"

#include <cstdint>
#include <utility>

namespace uplink::storage {
namespace {

/// A filter in the making. A statement uses the index of the first condition that has one, so those
/// that leave fewer rows come first.
class Conditions final {
 public:
  /// A robot's index is better than those of columns with few values, and of whole fleets' ids.
  explicit Conditions(const HistoryQuery& rows) : taken_(!rows.ruris.empty()) {}

  using Value = decltype(ListFilter::Condition::value);

  /// By a column with an index of its own.
  void Indexed(std::string_view sql, Value value) {
    filter_.conditions.push_back({sql, value, taken_});
    filter_.leads = filter_.leads || !taken_;
    taken_ = true;
  }
  /// By an id that is rarely two robots': its index is better than theirs.
  void Unique(std::string_view sql, std::string_view value) {
    filter_.conditions.push_back({sql, value});
    filter_.leads = true;
    taken_ = true;
  }
  /// Where no index is of this column, or one that begins with robot, fleet or time is.
  void Also(std::string_view sql, Value value = {}) { filter_.conditions.push_back({sql, value}); }

  [[nodiscard]] ListFilter Take() { return std::move(filter_); }

 private:
  ListFilter filter_;
  /// A better index is there already.
  bool taken_;
};

template <typename Enum>
constexpr std::int64_t Number(Enum member) {
  return static_cast<std::int64_t>(member);
}

}  // namespace

ListFilter FilterOf(const HistoryQuery& /*query*/, std::string_view /*open_column*/) { return {}; }

ListFilter FilterOf(const FaultsQuery& query, std::string_view /*open_column*/) {
  Conditions conditions(query.rows);
  if (!query.fault_id.empty()) conditions.Indexed("fault_id = ?", std::string_view(query.fault_id));
  if (query.severity) conditions.Indexed("severity = ?", Number(*query.severity));
  if (!query.source.empty()) conditions.Indexed("source = ?", std::string_view(query.source));
  return conditions.Take();
}

ListFilter FilterOf(const EventsQuery& query, std::string_view /*open_column*/) {
  Conditions conditions(query.rows);
  if (!query.kind.empty()) conditions.Indexed("kind = ?", std::string_view(query.kind));
  return conditions.Take();
}

ListFilter FilterOf(const MessagesQuery& query, std::string_view /*open_column*/) {
  Conditions conditions(query.rows);
  if (!query.level) return conditions.Take();
  // Most messages are of level info: the index has the others alone, and is taken if the statement
  // says so.
  static_assert(Number(model::MessageLevel::kInfo) == 0);
  if (*query.level == model::MessageLevel::kInfo) {
    conditions.Also("level = ?", Number(*query.level));
  } else {
    conditions.Also("level <> 0");
    conditions.Indexed("level = ?", Number(*query.level));
  }
  return conditions.Take();
}

ListFilter FilterOf(const MissionsQuery& query, std::string_view open_column) {
  Conditions conditions(query.rows);
  if (!query.run_id.empty()) conditions.Unique("run_id = ?", query.run_id);
  if (!query.mission_id.empty()) {
    conditions.Indexed("mission_id = ?", std::string_view(query.mission_id));
  }
  if (query.status) conditions.Indexed("status = ?", Number(*query.status));
  if (query.open && !open_column.empty()) conditions.Also(open_column);
  return conditions.Take();
}

ListFilter FilterOf(const PresentQuery& query, std::string_view /*open_column*/) {
  Conditions conditions(query.rows);
  if (!query.include_expired) {
    conditions.Also("(expires_ms = 0 OR expires_ms > ?)", UnixMs(query.now));
  }
  return conditions.Take();
}

ListFilter FilterOf(const ScopeUpdatesQuery& query, std::string_view /*open_column*/) {
  Conditions conditions(query.rows);
  if (!query.id.empty()) conditions.Unique("id = ?", query.id);
  if (query.scope) conditions.Indexed("scope = ?", Number(*query.scope));
  return conditions.Take();
}

ListFilter FilterOf(const OperatorRequestsQuery& query, std::string_view open_column) {
  Conditions conditions(query.rows);
  if (query.open) conditions.Also(open_column);
  return conditions.Take();
}

ListFilter FilterOf(const ConnectionsQuery& query, std::string_view open_column) {
  Conditions conditions(query.rows);
  if (query.why) conditions.Indexed("ended_why = ?", Number(*query.why));
  if (query.source) conditions.Indexed("source = ?", Number(*query.source));
  if (query.open) conditions.Also(open_column);
  return conditions.Take();
}

ListFilter FilterOf(const AuditQuery& query, std::string_view /*open_column*/) {
  Conditions conditions(query.rows);
  // The fewest rows are those of one target.
  if (!query.target.empty()) conditions.Indexed("target = ?", std::string_view(query.target));
  if (!query.who.empty()) conditions.Indexed("who = ?", std::string_view(query.who));
  if (!query.action.empty()) conditions.Indexed("action = ?", std::string_view(query.action));
  return conditions.Take();
}

ListFilter FilterOf(const QuarantineQuery& query, std::string_view /*open_column*/) {
  Conditions conditions(query.rows);
  if (query.reason) conditions.Indexed("reason = ?", Number(*query.reason));
  if (!query.source) return conditions.Take();
  // Nearly all rows are the relay's: the index has the others alone, and is taken if the statement
  // says so.
  if (*query.source == model::MessageSource::kUplink) {
    conditions.Also("source = ?", Number(*query.source));
  } else {
    conditions.Also("source <> 0");
    conditions.Indexed("source = ?", Number(*query.source));
  }
  return conditions.Take();
}

}  // namespace uplink::storage
