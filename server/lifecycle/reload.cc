#include "server/lifecycle/reload.h"

#include <algorithm>
#include <utility>

#include <fmt/ranges.h>

#include "server/config/settings.h"
#include "server/lifecycle/from_config.h"

namespace uplink::lifecycle {

Changes CompareConfigs(const config::Config& running, const config::Config& read) {
  Changes changes;
  for (const config::Setting& setting : config::Settings()) {
    if (setting.get(running) == setting.get(read)) continue;
    if (setting.effect == config::Effect::kReload) {
      changes.log_level = true;  // the only one so far
    } else {
      changes.needs_restart.push_back(config::FullKey(setting));
    }
  }
  return changes;
}

Reload::Reload(config::Config running, std::function<config::LoadResult()> read,
               log::Logger& logger)
    : running_(std::move(running)), read_(std::move(read)), logger_(logger) {}

void Reload::Run() {
  const config::LoadResult read = read_();
  for (const config::Problem& problem : read.problems) {
    logger_.Error("reload_refused", {{"problem", config::ToText(problem)}});
  }
  if (!read.ok()) return;
  const Changes changes = CompareConfigs(running_, *read.config);
  const log::Level after = LogLevelOf(read.config->log.level);
  // By whichever level lets the line through.
  logger_.SetLevel(std::min(LogLevelOf(running_.log.level), after));
  // Only the level is taken over, so that the next reload names the rest again.
  running_.log.level = read.config->log.level;
  logger_.Write(changes.needs_restart.empty() ? log::Level::kInfo : log::Level::kWarn, "reloaded",
                {{"log_level_changed", changes.log_level},
                 {"needs_restart", fmt::format("{}", fmt::join(changes.needs_restart, ","))}});
  logger_.SetLevel(after);
}

}  // namespace uplink::lifecycle
