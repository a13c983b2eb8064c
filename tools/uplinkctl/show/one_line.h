#pragma once

#include <string>
#include <string_view>

namespace uplink::ctl {

/// A foreign text on one line of a terminal: line ends and control characters of ASCII become
/// spaces, and what else PrintableUtf8 escapes is escaped.
[[nodiscard]] std::string OneLine(std::string_view text);

}  // namespace uplink::ctl
