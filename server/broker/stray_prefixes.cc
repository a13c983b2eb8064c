#include "server/broker/stray_prefixes.h"

#include <algorithm>
#include <iterator>

#include "schema/cyberwave/prefix.h"
#include "schema/cyberwave/topic.h"
#include "schema/cyberwave/topic_kinds.h"

namespace uplink::broker {

bool StrayPrefixes::Add(std::string_view topic) {
  const std::size_t root = topic.find(cyberwave::kRoot);
  if (root == std::string_view::npos || stray_.size() >= kStrayPrefixesMax) return false;
  const std::string prefix(topic.substr(0, root));
  const auto has = [&prefix](const std::vector<std::string>& prefixes) {
    return std::ranges::find(prefixes, prefix) != prefixes.end();
  };
  if (has(wanted_) || has(stray_) || !cyberwave::PrefixError(prefix).empty()) return false;
  stray_.push_back(prefix);
  return true;
}

std::vector<std::string> StrayPrefixes::Filters() const {
  std::vector<std::string> filters;
  for (const std::string& prefix : stray_) {
    std::ranges::move(cyberwave::Filters(prefix, cyberwave::Connection::kDurable),
                      std::back_inserter(filters));
  }
  return filters;
}

}  // namespace uplink::broker
