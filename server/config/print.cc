#include <fmt/core.h>

#include "server/config/load.h"
#include "server/config/settings.h"

namespace uplink::config {

std::string PrintConfig(const Config& config) {
  const Config defaults;
  std::string text;
  for (const Section& section : Sections()) {
    text += fmt::format("{}[{}]\n", text.empty() ? "" : "\n", section.name);
    for (const Setting& setting : Settings()) {
      if (setting.section != section.name) continue;
      const std::string value = ValueText(setting, setting.get(config));
      // Read back, it would be noted as a key that somebody set.
      if (setting.effect == Effect::kNone && value == ValueText(setting, setting.get(defaults))) {
        continue;
      }
      text += fmt::format("{} = {}\n", setting.key, value);
    }
  }
  return text;
}

}  // namespace uplink::config
