#include "server/run/reload.h"

#include <algorithm>
#include <utility>

#include <fmt/ranges.h>

#include "server/config/settings.h"
#include "server/run/from_config.h"

namespace uplink::run {

admin::Reloaded CompareConfigs(const config::Config& running, const config::Config& read) {
  admin::Reloaded changes;
  for (const config::Setting& setting : config::Settings()) {
    if (setting.get(running) == setting.get(read)) continue;
    std::vector<std::string>& keys =
        setting.effect == config::Effect::kReload ? changes.taken_over : changes.needs_restart;
    keys.push_back(config::FullKey(setting));
  }
  return changes;
}

Reload::Reload(config::Config running, Context context)
    : running_(std::move(running)), context_(std::move(context)) {}

admin::Reloaded Reload::Run() {
  log::Logger& logger = context_.logger;
  const config::LoadResult read = context_.read();
  admin::Reloaded refused;
  if (!read.ok()) {
    for (const config::Problem& problem : read.problems) {
      refused.problems.push_back(config::ToText(problem));
    }
  } else if (context_.look_at_files) {
    refused.problems = context_.look_at_files();
  }
  for (const std::string& problem : refused.problems) {
    logger.Error("reload_refused", {{"problem", problem}});
  }
  if (!read.ok() || !refused.problems.empty()) return refused;
  admin::Reloaded changes = CompareConfigs(running_, *read.config);
  const log::Level after = LogLevelOf(read.config->log.level);
  // The line is written if the old or the new level lets it through.
  logger.SetLevel(std::min(LogLevelOf(running_.log.level), after));
  // Nothing else is taken over, so that the next reload names the rest again.
  for (const config::Setting& setting : config::Settings()) {
    if (setting.effect == config::Effect::kReload) setting.set(running_, setting.get(*read.config));
  }
  context_.allowances.Set(AllowanceOf(running_));
  context_.in_effect.TakeOver(*read.config, read.places);
  if (context_.took_over) context_.took_over(running_);
  logger.Write(changes.needs_restart.empty() ? log::Level::kInfo : log::Level::kWarn, "reloaded",
               {{"taken_over", fmt::format("{}", fmt::join(changes.taken_over, ","))},
                {"needs_restart", fmt::format("{}", fmt::join(changes.needs_restart, ","))}});
  logger.SetLevel(after);
  return changes;
}

}  // namespace uplink::run
