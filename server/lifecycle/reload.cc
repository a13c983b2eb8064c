#include "server/lifecycle/reload.h"

#include "server/config/settings.h"

namespace uplink::lifecycle {

Reload CompareConfigs(const config::Config& running, const config::Config& read) {
  Reload reload;
  for (const config::Setting& setting : config::Settings()) {
    if (setting.get(running) == setting.get(read)) continue;
    if (setting.effect == config::Effect::kReload) {
      reload.log_level = true;  // the only one so far
    } else {
      reload.needs_restart.push_back(config::FullKey(setting));
    }
  }
  return reload;
}

}  // namespace uplink::lifecycle
