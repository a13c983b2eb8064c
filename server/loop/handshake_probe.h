#pragma once

#include <functional>

#include "server/config/address.h"
#include "server/loop/event_loop.h"

namespace uplink::loop {

/// Asks a TLS listener for a ServerHello and closes: `done(true)` if one came within `wait`, else
/// `done(false)`, on the loop's thread. An unspecified address is asked by its loopback.
///
/// Thread: the loop's.
void ProbeHandshake(EventLoop& loop, const config::ListenAddress& address, milliseconds wait,
                    std::function<void(bool)> done);

}  // namespace uplink::loop
