#include "tools/uplinkctl/listeners.h"

#include "server/config/address.h"

namespace uplink::ctl {

std::vector<Listener> ListenersOf(const config::Config& config) {
  std::vector<Listener> listeners = {{"listen.relay", config.listen.relay},
                                     {"listen.http", config.listen.http}};
  if (config::IsSet(config.listen.metrics)) {
    listeners.push_back({"listen.metrics", config.listen.metrics});
  }
  return listeners;
}

config::ListenAddress ProbeAddress(const config::Config& config) {
  config::ListenAddress address = config.listen.http;
  if (address.host == "0.0.0.0") address.host = "127.0.0.1";
  if (address.host == "::") address.host = "::1";
  return address;
}

}  // namespace uplink::ctl
