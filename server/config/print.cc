#include <fmt/core.h>

#include "server/config/effective.h"
#include "server/config/load.h"

namespace uplink::config {

std::string PrintConfig(const Config& config) {
  std::string text;
  std::string_view section;
  for (const EffectiveKey& key : EffectiveKeys(config, {})) {
    if (key.setting->section != section) {
      section = key.setting->section;
      text += fmt::format("{}[{}]\n", text.empty() ? "" : "\n", section);
    }
    text += fmt::format("{} = {}\n", key.setting->key, key.value);
  }
  return text;
}

}  // namespace uplink::config
