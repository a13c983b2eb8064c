#pragma once

#include <string>
#include <string_view>

namespace uplink::config {

/// What is said of a name that no setting has: the nearest that one has, or where to look. Each
/// ends a problem's sentence.
///
/// Thread: pure; any thread.
[[nodiscard]] std::string UnknownKeyText(std::string_view section, std::string_view key);
/// Of a table, or of a key that stands before the first section.
[[nodiscard]] std::string UnknownSectionText(std::string_view name);
[[nodiscard]] std::string KeyOutsideText(std::string_view key);
/// Of a variable that begins with UPLINKD_.
[[nodiscard]] std::string UnknownVariableText(std::string_view variable);

}  // namespace uplink::config
