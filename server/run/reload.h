#pragma once

#include <functional>
#include <string>
#include <vector>

#include "server/admin/commands.h"
#include "server/config/config.h"
#include "server/config/effective.h"
#include "server/config/load.h"
#include "server/ingest/allowances.h"
#include "server/log/logger.h"

namespace uplink::run {

/// Compares what runs with what was read. Pure.
[[nodiscard]] admin::Reloaded CompareConfigs(const config::Config& running,
                                             const config::Config& read);

/// What SIGHUP, a change of the file and a command do: reads the configuration again, takes over
/// what may change while the server runs, and names the rest in the log. Confined to one thread.
class Reload final {
 public:
  struct Context {
    std::function<config::LoadResult()> read;
    // They outlive it, and follow what is taken over.
    ingest::Allowances& allowances;
    log::Logger& logger;
    config::InEffect& in_effect;
    /// What is wrong with the other files that are followed, such as those of tokens and TLS: then
    /// nothing is taken over. Empty: there are none.
    std::function<std::vector<std::string>()> look_at_files{};
    /// Gets what is in effect from now on; may be empty.
    std::function<void(const config::Config& running)> took_over{};
  };
  /// `running`: what the server was started with.
  Reload(config::Config running, Context context);

  /// A configuration with a problem changes nothing.
  admin::Reloaded Run();

 private:
  config::Config running_;
  const Context context_;
};

}  // namespace uplink::run
