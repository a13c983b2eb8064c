#include "storage/postgres/read/lists.h"

namespace uplink::storage::postgres {

ListFilter FilterOf(const HistoryQuery& /*query*/, std::string_view /*open_if*/) { return {}; }

ListFilter FilterOf(const MissionsQuery& query, std::string_view open_if) {
  ListFilter filter;
  if (!query.mission_id.empty()) {
    filter.conditions.push_back({"mission_id = ?", std::string_view(query.mission_id)});
  }
  if (!query.run_id.empty()) {
    filter.conditions.push_back({"run_id = ?", std::string_view(query.run_id)});
  }
  if (query.open && !open_if.empty()) filter.conditions.push_back({open_if, {}});
  return filter;
}

ListFilter FilterOf(const PresentQuery& query, std::string_view /*open_if*/) {
  if (query.include_expired) return {};
  return {{{"(expires_ms = 0 OR expires_ms > ?)", UnixMs(query.now)}}};
}

}  // namespace uplink::storage::postgres
