#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "schema/base/clock.h"

namespace uplink::view {

/// One connection to a broker, as operators see it. A value; its texts are UTF-8.
struct BrokerConnection {
  /// `durable`, `live` or `media`.
  std::string name;
  std::string client_id;
  /// `stopped`, `connecting`, `subscribing`, `subscribed`, `waiting` or `id_taken`.
  std::string state;
  /// Empty while it is not connected.
  std::optional<SystemTime> connected_since;
  bool session_present = false;
  /// Messages that wait for their ack.
  std::size_t unacked = 0;
  std::size_t filters_refused = 0;
  std::size_t filters_lower = 0;
  /// Empty: nothing went wrong yet.
  std::string last_error;
  std::optional<SystemTime> last_error_at;
};

/// What this server does at a broker. A value; its texts are UTF-8.
struct BrokerStatus {
  /// Without user and password.
  std::string url;
  /// Whether this server reads the prefixes now.
  bool holds_lease = false;
  /// The server that reads them; empty if none is known.
  std::string held_by;
  std::vector<std::string> prefixes;
  /// Robots of twins that this server has heard and holds.
  std::size_t twins = 0;
  /// Empty while it gets no messages.
  std::optional<SystemTime> subscribed_since;
  std::vector<BrokerConnection> connections;
};

}  // namespace uplink::view
