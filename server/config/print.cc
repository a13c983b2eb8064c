#include <fmt/core.h>

#include "server/config/load.h"
#include "server/config/settings.h"

namespace uplink::config {

std::string PrintConfig(const Config& config) {
  std::string text;
  for (const Section& section : Sections()) {
    text += fmt::format("{}[{}]\n", text.empty() ? "" : "\n", section.name);
    for (const Setting& setting : Settings()) {
      if (setting.section == section.name) {
        text += fmt::format("{} = {}\n", setting.key, ValueText(setting, setting.get(config)));
      }
    }
  }
  return text;
}

}  // namespace uplink::config
