#pragma once

#include <string>
#include <string_view>

namespace CLI {
class App;
}

namespace uplink::config {

/// The flag by which a program prints its HelpTree.
inline constexpr std::string_view kHelpTree = "--help-tree";

/// All flags and commands of a program as JSON, for the manual pages and the completion of shells.
[[nodiscard]] std::string HelpTree(const CLI::App& program);

}  // namespace uplink::config
