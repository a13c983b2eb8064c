#include "storage/sqlite/lists.h"

namespace uplink::storage::sqlite {

ListFilter FilterOf(const HistoryQuery& /*query*/, std::string_view /*open_if*/) { return {}; }

ListFilter FilterOf(const MissionsQuery& query, std::string_view open_if) {
  ListFilter filter;
  if (!query.mission_id.empty()) {
    // A mission may be that of a whole fleet: where a robot is named, its index is the better one.
    filter.sql += query.rows.ruri.empty() ? " AND mission_id = ?" : " AND +mission_id = ?";
    filter.values.emplace_back(std::string_view(query.mission_id));
  }
  if (!query.run_id.empty()) {
    filter.sql += " AND run_id = ?";
    filter.values.emplace_back(std::string_view(query.run_id));
  }
  if (query.open && !open_if.empty()) filter.sql.append(" AND ").append(open_if);
  return filter;
}

ListFilter FilterOf(const PresentQuery& query, std::string_view /*open_if*/) {
  if (query.include_expired) return {};
  return {" AND (expires_ms = 0 OR expires_ms > ?)", {UnixMs(query.now)}};
}

ListFilter FilterOf(const ScopeUpdatesQuery& query, std::string_view /*open_if*/) {
  ListFilter filter;
  if (query.scope) {
    // Where an id is named, its index is the better one.
    filter.sql += query.id.empty() ? " AND scope = ?" : " AND +scope = ?";
    filter.values.emplace_back(static_cast<std::int64_t>(*query.scope));
  }
  if (!query.id.empty()) {
    filter.sql += " AND id = ?";
    filter.values.emplace_back(std::string_view(query.id));
  }
  return filter;
}

ListFilter FilterOf(const QuarantineQuery& query, std::string_view /*open_if*/) {
  if (!query.source) return {};
  // Nearly all rows are the relay's: the index has the others alone, and is taken if the statement
  // says so.
  const bool indexed = *query.source != model::MessageSource::kUplink;
  return {indexed ? " AND source <> 0 AND source = ?" : " AND source = ?",
          {static_cast<std::int64_t>(*query.source)}};
}

}  // namespace uplink::storage::sqlite
