#include <algorithm>
#include <array>
#include <string>
#include <string_view>

#include "schema/cyberwave/detail.h"
#include "schema/cyberwave/families.h"
#include "schema/limits.h"

namespace uplink::cyberwave {
namespace {

using model::cyberwave::DriverLog;
using model::cyberwave::LogLevel;

struct LevelWord {
  std::string_view word;
  LogLevel level;
};
constexpr std::array kLevels = {
    LevelWord{"debug", LogLevel::kDebug},     LevelWord{"info", LogLevel::kInfo},
    LevelWord{"warning", LogLevel::kWarning}, LevelWord{"warn", LogLevel::kWarning},
    LevelWord{"error", LogLevel::kError},     LevelWord{"critical", LogLevel::kCritical},
};

LogLevel LevelOf(std::string text) {
  for (char& c : text) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  const auto found = std::find_if(kLevels.begin(), kLevels.end(),
                                  [&text](const LevelWord& each) { return each.word == text; });
  return found == kLevels.end() ? LogLevel::kUnknown : found->level;
}

}  // namespace

DriverLog ReadDriverLog(Reader& in, boost::json::object& object) {
  DriverLog log;
  log.message = in.Text("message", schema::kMessageTextBytesMax, Need::kMust);
  log.level_text = in.Text("level", schema::kNameBytesMax, Need::kMust);
  log.level = LevelOf(log.level_text);
  log.container_name = in.Text("container_name", schema::kNameBytesMax);
  log.source = in.Text("source", schema::kNameBytesMax);
  // Kept in the detail alone, under the same rule.
  for (const std::string_view name : {"edge_core_version", "sdk_version", "driver_image"}) {
    (void)in.Text(name, schema::kNameBytesMax);
  }
  object.erase("message");
  log.detail = DetailOf(object, in.violations());
  return log;
}

}  // namespace uplink::cyberwave
