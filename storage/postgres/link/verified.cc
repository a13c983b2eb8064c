#include "storage/postgres/link/verified.h"

#include <memory>
#include <string_view>
#include <utility>
#include <vector>

#include <arpa/inet.h>
#include <libpq-fe.h>
#include <netinet/in.h>

namespace uplink::storage::postgres {
namespace {

using Settings = std::vector<std::pair<std::string, std::string>>;

struct FreeOptions {
  void operator()(PQconninfoOption* options) const { PQconninfoFree(options); }
};

/// What libpq takes where the URL says nothing.
Settings Defaults() {
  Settings defaults;
  const std::unique_ptr<PQconninfoOption, FreeOptions> options(PQconndefaults());
  if (options == nullptr) return defaults;
  for (const PQconninfoOption* option = options.get(); option->keyword != nullptr; ++option) {
    if (option->val != nullptr) defaults.emplace_back(option->keyword, option->val);
  }
  return defaults;
}

/// The value of a keyword: the settings' own, else the default.
std::string Find(const Settings& settings, std::string_view keyword, const Settings& defaults) {
  for (const Settings* each : {&settings, &defaults}) {
    for (const auto& [name, value] : *each) {
      if (name == keyword && !value.empty()) return value;
    }
  }
  return {};
}

bool IsLoopbackAddress(const std::string& host) {
  in_addr v4{};
  if (::inet_pton(AF_INET, host.c_str(), &v4) == 1) return ntohl(v4.s_addr) >> 24U == 127;
  in6_addr v6{};
  return ::inet_pton(AF_INET6, host.c_str(), &v6) == 1 && IN6_IS_ADDR_LOOPBACK(&v6);
}

/// libpq reads a host that begins so as a Unix socket: a path, or an abstract name.
bool IsOfThisMachine(const std::string& host) {
  return host.empty() || host.front() == '/' || host.front() == '@' || host == "localhost" ||
         IsLoopbackAddress(host);
}

}  // namespace

std::optional<Unverified> FindUnverified(const Url& url) {
  const Settings defaults = Defaults();
  const std::string sslmode = Find(url.settings, "sslmode", defaults);
  if (sslmode == "verify-full") return std::nullopt;
  for (const Settings& place : url.places) {
    // An address is where it connects to; the name is then only what a certificate must bear.
    std::string host = Find(place, "hostaddr", defaults);
    if (host.empty()) host = Find(place, "host", defaults);
    if (!IsOfThisMachine(host)) return Unverified{host, sslmode};
  }
  return std::nullopt;
}

}  // namespace uplink::storage::postgres
