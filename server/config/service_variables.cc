#include "server/config/service_variables.h"

#include <algorithm>
#include <array>
#include <cstddef>

#include <fmt/format.h>

namespace uplink::config {
namespace {

/// A Service has at least seven variables: a few are enough to know it by.
constexpr std::size_t kNamesShownMax = 3;

constexpr std::string_view kPrefix = "UPLINKD_";
constexpr std::array<std::string_view, 3> kProtocols = {"TCP", "UDP", "SCTP"};

bool IsUrl(std::string_view value) {
  return value.starts_with("tcp://") || value.starts_with("udp://") || value.starts_with("sctp://");
}

/// `X_SERVICE_HOST`, `X_SERVICE_PORT` and `X_SERVICE_PORT_Y`.
bool IsOfHost(std::string_view rest) {
  return rest.ends_with("_SERVICE_HOST") || rest.ends_with("_SERVICE_PORT") ||
         rest.find("_SERVICE_PORT_") != std::string_view::npos;
}

/// `X_PORT=tcp://...`.
bool IsOfUrl(std::string_view rest, std::string_view value) {
  return rest.ends_with("_PORT") && IsUrl(value);
}

/// `X_PORT_7443_TCP=tcp://...`, and with `_PROTO`, `_PORT` or `_ADDR` behind it any value.
bool IsOfPortNumber(std::string_view rest, std::string_view value) {
  constexpr std::string_view kPort = "_PORT_";
  for (std::size_t at = rest.find(kPort); at != std::string_view::npos;
       at = rest.find(kPort, at + 1)) {
    std::string_view tail = rest.substr(at + kPort.size());
    const std::size_t digits = std::min(tail.find_first_not_of("0123456789"), tail.size());
    tail.remove_prefix(digits);
    if (digits == 0 || !tail.starts_with('_')) continue;
    tail.remove_prefix(1);
    for (const std::string_view protocol : kProtocols) {
      if (!tail.starts_with(protocol)) continue;
      const std::string_view part = tail.substr(protocol.size());
      if (part.empty() ? IsUrl(value) : part == "_PROTO" || part == "_PORT" || part == "_ADDR") {
        return true;
      }
    }
  }
  return false;
}

}  // namespace

bool IsServiceVariable(std::string_view name, std::string_view value) {
  if (name == "UPLINKD_PORT" || name.starts_with("UPLINKD_PORT_") ||
      name.starts_with("UPLINKD_SERVICE_")) {
    return true;
  }
  // Set for a Service uplinkd-..., with a name that we do not know further.
  if (!name.starts_with(kPrefix)) return false;
  const std::string_view rest = name.substr(kPrefix.size());
  return IsOfHost(rest) || IsOfUrl(rest, value) || IsOfPortNumber(rest, value);
}

std::string IgnoredText(const std::vector<std::string>& names) {
  const std::size_t shown = std::min(names.size(), kNamesShownMax);
  std::string text = fmt::format(
      "{}", fmt::join(names.begin(), names.begin() + static_cast<std::ptrdiff_t>(shown), ", "));
  if (shown < names.size()) text += fmt::format(" and {} more", names.size() - shown);
  return text +
         ": ignored; Kubernetes sets such variables where a Service is named uplinkd or "
         "uplinkd-..., and no key has their names";
}

}  // namespace uplink::config
