#include "storage/tables/lists.h"

namespace uplink::storage {

ListFilter FilterOf(const HistoryQuery& /*query*/, std::string_view /*open_column*/) { return {}; }

ListFilter FilterOf(const MissionsQuery& query, std::string_view open_column) {
  ListFilter filter;
  if (!query.mission_id.empty()) {
    // A mission may be that of a whole fleet: where a robot is named, its index is the better one.
    filter.conditions.push_back(
        {"mission_id = ?", std::string_view(query.mission_id), !query.rows.ruri.empty()});
  }
  if (!query.run_id.empty()) {
    filter.conditions.push_back({"run_id = ?", std::string_view(query.run_id)});
  }
  if (query.open && !open_column.empty()) filter.conditions.push_back({open_column});
  return filter;
}

ListFilter FilterOf(const PresentQuery& query, std::string_view /*open_column*/) {
  if (query.include_expired) return {};
  return {{{"(expires_ms = 0 OR expires_ms > ?)", UnixMs(query.now)}}};
}

ListFilter FilterOf(const ScopeUpdatesQuery& query, std::string_view /*open_column*/) {
  ListFilter filter;
  if (query.scope) {
    // Where an id is named, its index is the better one.
    filter.conditions.push_back(
        {"scope = ?", static_cast<std::int64_t>(*query.scope), !query.id.empty()});
  }
  if (!query.id.empty()) filter.conditions.push_back({"id = ?", std::string_view(query.id)});
  return filter;
}

ListFilter FilterOf(const OperatorRequestsQuery& query, std::string_view open_column) {
  if (!query.open) return {};
  return {{{open_column}}};
}

ListFilter FilterOf(const QuarantineQuery& query, std::string_view /*open_column*/) {
  if (!query.source) return {};
  // Nearly all rows are the relay's: the index has the others alone, and is taken if the statement
  // says so.
  const bool indexed = *query.source != model::MessageSource::kUplink;
  return {{{indexed ? "source <> 0 AND source = ?" : "source = ?",
            static_cast<std::int64_t>(*query.source)}}};
}

}  // namespace uplink::storage
