#include "server/config/effective.h"

#include <utility>

namespace uplink::config {

std::vector<EffectiveKey> EffectiveKeys(const Config& config, const Places& places) {
  const Config defaults;
  std::vector<EffectiveKey> keys;
  for (const Setting& setting : Settings()) {
    std::string value = ValueText(setting, setting.get(config));
    if (setting.effect == Effect::kNone && value == ValueText(setting, setting.get(defaults))) {
      continue;
    }
    const auto place = places.find(FullKey(setting));
    keys.push_back({&setting, std::move(value), place == places.end() ? "" : place->second});
  }
  return keys;
}

InEffect::InEffect(std::string file, Config config, Places places)
    : file_(std::move(file)), config_(std::move(config)), places_(std::move(places)) {}

void InEffect::TakeOver(const Config& read, const Places& places) {
  const std::lock_guard lock(mutex_);
  for (const Setting& setting : Settings()) {
    if (setting.effect != Effect::kReload) continue;
    setting.set(config_, setting.get(read));
    const std::string key = FullKey(setting);
    const auto place = places.find(key);
    if (place == places.end()) {
      places_.erase(key);
    } else {
      places_[key] = place->second;
    }
  }
}

std::vector<EffectiveKey> InEffect::Keys() const {
  const std::lock_guard lock(mutex_);
  return EffectiveKeys(config_, places_);
}

}  // namespace uplink::config
