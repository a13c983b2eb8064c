#pragma once

#include <functional>
#include <string>
#include <vector>

#include "server/config/config.h"
#include "server/config/load.h"
#include "server/log/logger.h"

namespace uplink::lifecycle {

/// What a configuration that was read again asks for. A value.
struct Changes {
  /// The level changed; it is set at once.
  bool log_level = false;
  /// Keys that changed and count only after a restart.
  std::vector<std::string> needs_restart;
};

/// Compares what runs with what was read. Pure.
[[nodiscard]] Changes CompareConfigs(const config::Config& running, const config::Config& read);

/// What SIGHUP does: reads the configuration again, takes over what may change while the server
/// runs, and names the rest in the log. Confined to one thread.
class Reload final {
 public:
  /// `running`: what the server was started with. The logger outlives it.
  Reload(config::Config running, std::function<config::LoadResult()> read, log::Logger& logger);

  /// A configuration with a problem changes nothing.
  void Run();

 private:
  config::Config running_;
  const std::function<config::LoadResult()> read_;
  log::Logger& logger_;
};

}  // namespace uplink::lifecycle
