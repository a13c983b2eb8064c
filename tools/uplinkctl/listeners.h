#pragma once

#include <string>
#include <vector>

#include "server/config/config.h"
#include "tools/uplinkctl/ask/server_url.h"

namespace uplink::ctl {

/// A port or a Unix socket that the server opens.
struct Listener {
  /// `listen.relay`.
  std::string key;
  config::ListenAddress address;
};

/// Those that the configuration opens.
[[nodiscard]] std::vector<Listener> ListenersOf(const config::Config& config);

/// Where the server answers a client on its machine: a listener on all addresses is asked on
/// loopback, and by https if http.plain_from does not let this machine do without. Port 0 if the
/// server takes any.
[[nodiscard]] ServerUrl OwnUrl(const config::Config& config);

}  // namespace uplink::ctl
