#include "schema/cyberwave/filters.h"

#include "schema/cyberwave/topic.h"

namespace uplink::cyberwave {

std::vector<std::string> Filters(std::string_view prefix, Connection connection) {
  std::vector<std::string> filters;
  for (const TopicRow& row : TopicRows()) {
    if (row.connection != connection) continue;
    std::string filter(prefix);
    filter.append(kRoot).append(row.scope).append("/+/").append(row.tail);
    filters.push_back(std::move(filter));
  }
  return filters;
}

}  // namespace uplink::cyberwave
