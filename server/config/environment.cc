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

/// Empty if it is not set.
std::string ValueOf(std::string_view variable) {
  for (const auto& [name, value] : VariablesThatBeginWith(variable)) {
    if (name == variable) return value;
  }
  return "";
}

}  // namespace

Environment ProcessEnvironment() { return VariablesThatBeginWith("UPLINKD_"); }

std::string BootIdOfManager() { return ValueOf(kBootIdVariable); }

std::string JournalStream() { return ValueOf("JOURNAL_STREAM"); }

}  // namespace uplink::config
