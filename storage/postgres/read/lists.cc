#include "storage/postgres/read/lists.h"

namespace uplink::storage::postgres {

ListFilter FilterOf(const MissionsQuery& query, bool open) {
  ListFilter filter;
  if (!query.mission_id.empty()) {
    filter.conditions.push_back({"mission_id = ?", std::string_view(query.mission_id)});
  }
  if (!query.run_id.empty()) {
    filter.conditions.push_back({"run_id = ?", std::string_view(query.run_id)});
  }
  if (open) filter.conditions.push_back({"is_open", {}});
  return filter;
}

ListFilter FilterOf(const PresentQuery& query) {
  if (query.include_expired) return {};
  return {{{"(expires_ms = 0 OR expires_ms > ?)", UnixMs(query.now)}}};
}

}  // namespace uplink::storage::postgres
