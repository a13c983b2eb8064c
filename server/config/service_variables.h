#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace uplink::config {

/// True for a variable that Kubernetes sets in containers because a Service is named `uplinkd`
/// (`UPLINKD_SERVICE_*`, `UPLINKD_PORT` and `UPLINKD_PORT_*`; no key has such a name), or
/// `uplinkd-...`: `UPLINKD_*_SERVICE_HOST`, `UPLINKD_*_SERVICE_PORT*`,
/// `UPLINKD_*_PORT_<number>_<protocol>_*`, and, with a URL as value, `UPLINKD_*_PORT` and
/// `UPLINKD_*_PORT_<number>_<protocol>`. First make sure that no key has this name. Pure.
[[nodiscard]] bool IsServiceVariable(std::string_view name, std::string_view value);

/// One sentence that says of these variables that they are ignored; it names the first few. Pure.
[[nodiscard]] std::string IgnoredText(const std::vector<std::string>& names);

}  // namespace uplink::config
