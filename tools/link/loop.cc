#include "tools/link/loop.h"

#include <fmt/core.h>

namespace uplink::link {

absl::StatusOr<Address> Resolve(const std::string& host_port) {
  const std::size_t colon = host_port.rfind(':');
  if (colon == std::string::npos || colon == 0 || colon + 1 == host_port.size()) {
    return absl::InvalidArgumentError(fmt::format("\"{}\" is not HOST:PORT", host_port));
  }
  Address address;
  address.text = host_port;
  address.host = host_port.substr(0, colon);
  if (address.host.front() == '[' && address.host.back() == ']') {
    address.host = address.host.substr(1, address.host.size() - 2);
  }
  boost::asio::io_context io;
  boost::system::error_code error;
  const auto found =
      boost::asio::ip::tcp::resolver(io).resolve(address.host, host_port.substr(colon + 1), error);
  if (error) return absl::UnavailableError(fmt::format("{}: {}", host_port, error.message()));
  for (const auto& each : found) address.endpoints.push_back(each.endpoint());
  return address;
}

}  // namespace uplink::link
