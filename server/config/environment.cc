#include <unistd.h>

#include "server/config/load.h"

namespace uplink::config {

namespace {

Environment VariablesThatBeginWith(std::string_view prefix) {
  Environment environment;
  for (char** entry = environ; entry != nullptr && *entry != nullptr; ++entry) {
    const std::string_view text(*entry);
    const std::size_t equals = text.find('=');
    if (text.starts_with(prefix) && equals != std::string_view::npos) {
      environment.emplace_back(text.substr(0, equals), text.substr(equals + 1));
    }
  }
  return environment;
}

}  // namespace

Environment ProcessEnvironment() { return VariablesThatBeginWith("UPLINKD_"); }

std::string BootIdOfManager() {
  for (const auto& [name, value] : VariablesThatBeginWith(kBootIdVariable)) {
    if (name == kBootIdVariable) return value;
  }
  return "";
}

}  // namespace uplink::config
