#include <cstdlib>

#include <unistd.h>

#include "server/config/load.h"

namespace uplink::config {

Environment ProcessEnvironment() {
  constexpr std::string_view kPrefix = "UPLINKD_";
  Environment environment;
  for (char** entry = environ; entry != nullptr && *entry != nullptr; ++entry) {
    const std::string_view text(*entry);
    const std::size_t equals = text.find('=');
    if (text.starts_with(kPrefix) && equals != std::string_view::npos) {
      environment.emplace_back(text.substr(0, equals), text.substr(equals + 1));
    }
  }
  return environment;
}

std::string BootIdOfManager() {
  const char* const boot = std::getenv(kBootIdVariable);
  return boot == nullptr ? "" : boot;
}

}  // namespace uplink::config
