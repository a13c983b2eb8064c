#include "server/config/service_variables.h"

#include <algorithm>
#include <cstddef>

#include <fmt/format.h>

namespace uplink::config {
namespace {

/// A Service has seven variables, and four more for each further port.
constexpr std::size_t kNamesShownMax = 3;

}  // namespace

bool IsServiceVariable(std::string_view name) {
  return name == "UPLINKD_PORT" || name.starts_with("UPLINKD_PORT_") ||
         name.starts_with("UPLINKD_SERVICE_");
}

std::string IgnoredText(const std::vector<std::string>& names) {
  const std::size_t shown = std::min(names.size(), kNamesShownMax);
  std::string text = fmt::format(
      "{}", fmt::join(names.begin(), names.begin() + static_cast<std::ptrdiff_t>(shown), ", "));
  if (shown < names.size()) text += fmt::format(" and {} more", names.size() - shown);
  return text +
         ": ignored; Kubernetes sets such variables where a Service is named uplinkd, and no key "
         "has their names";
}

}  // namespace uplink::config
