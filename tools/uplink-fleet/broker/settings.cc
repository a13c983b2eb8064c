#include "tools/uplink-fleet/broker/settings.h"

#include <charconv>
#include <string_view>
#include <system_error>

#include <fmt/core.h>

namespace uplink::synthetic {
namespace {

constexpr std::string_view kPlain = "mqtt://";
constexpr std::string_view kTls = "mqtts://";

absl::Status NoUrl(const std::string& url) {
  return absl::InvalidArgumentError(
      fmt::format("\"{}\" is not mqtt://HOST:PORT or mqtts://HOST:PORT", url));
}

}  // namespace

absl::StatusOr<BrokerAddress> ParseBrokerUrl(const std::string& url) {
  BrokerAddress address;
  std::string_view rest = url;
  if (rest.starts_with(kTls)) {
    address.tls = true;
    rest.remove_prefix(kTls.size());
  } else if (rest.starts_with(kPlain)) {
    rest.remove_prefix(kPlain.size());
  } else {
    return NoUrl(url);
  }
  const std::size_t colon = rest.rfind(':');
  if (colon == std::string_view::npos || colon == 0) return NoUrl(url);
  std::string_view host = rest.substr(0, colon);
  const std::string_view port = rest.substr(colon + 1);
  const auto read = std::from_chars(port.data(), port.data() + port.size(), address.port);
  if (read.ec != std::errc() || read.ptr != port.data() + port.size() || address.port == 0) {
    return NoUrl(url);
  }
  if (host.starts_with('[') && host.ends_with(']')) host = host.substr(1, host.size() - 2);
  if (host.empty() || host.find_first_of("/@ ") != std::string_view::npos) return NoUrl(url);
  address.host = host;
  return address;
}

}  // namespace uplink::synthetic
