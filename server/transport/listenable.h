#pragma once

#include <string>

#include <absl/status/status.h>

#include "server/config/address.h"

namespace uplink::transport {

/// OK if the system lets us bind `address`. Otherwise kUnavailable, which names the address and the
/// system's reason. On a machine without IPv6, `::` stands for all of IPv4.
[[nodiscard]] absl::Status CheckListenable(const config::ListenAddress& address);

/// The host to bind: that of the address; `0.0.0.0` for `::` on a machine without IPv6.
[[nodiscard]] std::string ListenHost(const config::ListenAddress& address);

}  // namespace uplink::transport
