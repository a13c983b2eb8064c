#pragma once

#include <string>
#include <string_view>

namespace uplink::metrics {

/// Appends a label's value with `\`, `"` and newline escaped, as both formats want it.
void AppendEscaped(std::string& text, std::string_view value);

}  // namespace uplink::metrics
