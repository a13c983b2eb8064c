#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "server/config/address.h"
#include "server/config/networks.h"
#include "server/loop/event_loop.h"

namespace uplink::loop {

/// A listener to probe. A value.
struct ProbeTarget {
  config::ListenAddress address;
  /// The networks from which it requires a PROXY header: if we come from one of them, we send
  /// `proxy_header` first.
  std::vector<config::Network> proxy_protocol_from;
  std::string proxy_header;
  /// Set to the local port before each connection is made, so that the listener can recognize us;
  /// may be null. It outlives the handshake.
  std::atomic<std::uint16_t>* own_port = nullptr;
};

/// Asks a TLS listener for a ServerHello and closes. Calls `done` on the loop's thread: with true
/// if a ServerHello came within `wait`, otherwise with false. For an unspecified address it asks
/// the loopback: for `::` that is `::1`, and `127.0.0.1` if there is no IPv6 or nothing listens on
/// `::1`; `wait` holds for both together. If `::1` accepts and does not answer, `done` gets false.
///
/// Thread: the loop's.
void ProbeHandshake(EventLoop& loop, const ProbeTarget& target, milliseconds wait,
                    std::function<void(bool)> done);

}  // namespace uplink::loop
