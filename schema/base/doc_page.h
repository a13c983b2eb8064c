#pragma once

#include <string>
#include <string_view>

namespace uplink {

/// Where packages put docs/ (cmake/UplinkInstall.cmake).
inline constexpr std::string_view kDocFolder = "/usr/share/doc/uplinkd";

/// How a message refers to a page of the handbook: `docs/operate/sqlite.md in
/// /usr/share/doc/uplinkd`. `page` is its path in the source tree; tests/tidy looks whether it is
/// there.
[[nodiscard]] inline std::string DocPage(std::string_view page) {
  return std::string(page) + " in " + std::string(kDocFolder);
}

/// The same for the section under that heading.
[[nodiscard]] inline std::string DocPage(std::string_view page, std::string_view section) {
  return "\"" + std::string(section) + "\" of " + DocPage(page);
}

}  // namespace uplink
