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

/// A listener as its robots see it. A value.
struct ProbeTarget {
  config::ListenAddress address;
  /// From whom it requires a PROXY header: if we come from one of them, we say `proxy_header`
  /// first.
  std::vector<config::Network> proxy_protocol_from;
  std::string proxy_header;
  /// Set to the local port before each connection is made, so that the listener may know us by it;
  /// may be null. It outlives the handshake.
  std::atomic<std::uint16_t>* own_port = nullptr;
};

/// Asks a TLS listener for a ServerHello and closes: `done(true)` if one came within `wait`, else
/// `done(false)`, on the loop's thread. An unspecified address is asked by its loopback: `::` by
/// `::1`, and by `127.0.0.1` where nobody is there (no IPv6, or nothing listens on it); `wait`
/// holds for both together. A `::1` that takes the connection and does not answer is the answer.
///
/// Thread: the loop's.
void ProbeHandshake(EventLoop& loop, const ProbeTarget& target, milliseconds wait,
                    std::function<void(bool)> done);

}  // namespace uplink::loop
