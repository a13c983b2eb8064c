#include "tools/uplinkctl/show/short_names.h"

#include <map>

namespace uplink::ctl {

std::string_view LastSegments(std::string_view ruri, int count) {
  std::size_t at = ruri.size();
  for (int i = 0; i < count && at != std::string_view::npos && at > 0; ++i) {
    at = ruri.rfind('/', at - 1);
  }
  return at == std::string_view::npos || at == 0 ? ruri : ruri.substr(at + 1);
}

ShortNames ShortNamesOf(const std::vector<std::string>& ruris) {
  ShortNames names;
  for (const std::string& ruri : ruris) names.emplace(ruri, "");
  for (const int segments : {1, 2}) {
    std::map<std::string_view, int> uses;
    for (const auto& [ruri, name] : names) ++uses[LastSegments(ruri, segments)];
    for (auto& [ruri, name] : names) {
      const std::string_view last = LastSegments(ruri, segments);
      if (name.empty() && uses[last] == 1) name = last;
    }
  }
  for (auto& [ruri, name] : names) {
    if (name.empty()) name = ruri;
  }
  return names;
}

}  // namespace uplink::ctl
