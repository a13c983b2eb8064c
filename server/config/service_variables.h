#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace uplink::config {

/// True for a variable that Kubernetes sets in containers because a Service is named `uplinkd`:
/// `UPLINKD_SERVICE_*`, `UPLINKD_PORT` and `UPLINKD_PORT_*`. No key has such a name. Pure.
[[nodiscard]] bool IsServiceVariable(std::string_view name);

/// One sentence that says of these variables that they are ignored; it names the first few. Pure.
[[nodiscard]] std::string IgnoredText(const std::vector<std::string>& names);

}  // namespace uplink::config
