#include "tools/uplinkctl/listeners.h"

#include <cstring>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include "server/config/address.h"
#include "server/config/networks.h"

namespace uplink::ctl {
namespace {

sockaddr_storage StorageOf(const std::string& host) {
  sockaddr_storage storage{};
  sockaddr_in v4{};
  v4.sin_family = AF_INET;
  sockaddr_in6 v6{};
  v6.sin6_family = AF_INET6;
  if (inet_pton(AF_INET, host.c_str(), &v4.sin_addr) == 1) {
    std::memcpy(&storage, &v4, sizeof v4);
  } else if (inet_pton(AF_INET6, host.c_str(), &v6.sin6_addr) == 1) {
    std::memcpy(&storage, &v6, sizeof v6);
  }
  return storage;
}

}  // namespace

std::vector<Listener> ListenersOf(const config::Config& config) {
  std::vector<Listener> listeners = {{"listen.relay", config.listen.relay},
                                     {"listen.http", config.listen.http}};
  if (config::IsSet(config.listen.fleet)) {
    listeners.push_back({"listen.fleet", config.listen.fleet});
  }
  if (config::IsSet(config.listen.metrics)) {
    listeners.push_back({"listen.metrics", config.listen.metrics});
  }
  return listeners;
}

ServerUrl OwnUrl(const config::Config& config) {
  config::ListenAddress address = config.listen.http;
  if (config::IsUnix(address)) return {.address = address.path};
  // [::] serves IPv4 too, and a container may have no ::1.
  if (address.host == "0.0.0.0" || address.host == "::") address.host = "127.0.0.1";
  // The address of a connection within a machine is on both ends.
  const bool plain = config::Contains(config::PlainFrom(config.http), StorageOf(address.host));
  return {.address = config::ToText(address), .tls = config::SpeaksTls(config.http) && !plain};
}

}  // namespace uplink::ctl
