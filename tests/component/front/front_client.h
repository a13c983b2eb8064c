#pragma once

#include <cstdint>
#include <string>

#include "server/transport/turned_away.h"
#include "tests/support/listener_world.h"
#include "tests/support/raw_http2.h"
#include "tests/support/relay_bytes.h"

namespace uplink::testing {

[[nodiscard]] KeyPair RobotKeys(const ListenerWorld& world, int number);
/// Many streams on a connection.
[[nodiscard]] KeyPair GatewayKeys(const ListenerWorld& world);
/// A raw client that shows this identity; empty: none.
[[nodiscard]] RawHttp2::Options ClientOf(const ListenerWorld& world, const KeyPair& identity,
                                         const std::string& source = {});

/// Connections that were turned away for this.
[[nodiscard]] std::int64_t TurnedAwayFor(const ListenerWorld& world, transport::TurnedAway cause);

}  // namespace uplink::testing
