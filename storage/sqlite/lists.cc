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

}  // namespace uplink::storage::sqlite
