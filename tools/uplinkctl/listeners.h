#pragma once

#include <string>
#include <vector>

#include "server/config/config.h"

namespace uplink::ctl {

/// A port that the server opens.
struct Listener {
  /// `listen.relay`.
  std::string key;
  config::ListenAddress address;
};

/// Those that the configuration opens.
[[nodiscard]] std::vector<Listener> ListenersOf(const config::Config& config);

/// Where the server answers probes, for a client on its machine: a listener on all addresses is
/// asked on loopback. Port 0 if the server takes any.
[[nodiscard]] config::ListenAddress ProbeAddress(const config::Config& config);

}  // namespace uplink::ctl
