#pragma once

#include <string>
#include <vector>

#include "server/config/config.h"

namespace uplink::lifecycle {

/// What a configuration that was read again asks for. A value.
struct Reload {
  /// The level changed; it is set at once.
  bool log_level = false;
  /// Keys that changed and count only after a restart.
  std::vector<std::string> needs_restart;
};

/// Compares what runs with what was read. Pure.
[[nodiscard]] Reload CompareConfigs(const config::Config& running, const config::Config& read);

}  // namespace uplink::lifecycle
