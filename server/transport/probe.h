#pragma once

#include <array>
#include <atomic>
#include <cstdint>

#include "metrics/cells.h"
#include "server/transport/turned_away.h"

namespace uplink::transport {

/// What the transport counts beside its sessions. Thread-safe; one for all queues.
struct RelayProbe {
  /// Calls that ended before they became a session.
  metrics::Cell refused_full_total;
  /// One certificate has too many streams.
  metrics::Cell refused_robot_total;
  /// One gateway has too many streams.
  metrics::Cell refused_gateway_total;
  /// Streams that came through gateways, now.
  metrics::Cell gateway_streams;
  metrics::Cell refused_draining_total;
  metrics::Cell refused_identity_total;
  /// Requests for something other than the relay's call.
  metrics::Cell refused_request_total;
  /// TLS handshakes that failed.
  metrics::Cell handshakes_failed_total;
  /// Connections that we ended before they had a stream, or for their behaviour, by TurnedAway.
  std::array<metrics::Cell, kTurnedAwayTexts.size()> turned_away_total;
  /// Connections whose certificates may not come in, by Denied.
  std::array<metrics::Cell, kDeniedTexts.size()> denied_total;
  /// Connections that have shown a trusted certificate, and how many may.
  metrics::Cell connections;
  metrics::Cell connections_limit;
  metrics::Cell handshakes_under_way;
  /// Connections that wait for their handshake to begin.
  metrics::Cell handshakes_waiting;
  /// Connections of load balancers whose PROXY header is incomplete.
  metrics::Cell proxy_headers_waiting;
  /// Memory of incomplete frames, and calls that were ended because it was used up.
  metrics::Cell unfinished_bytes;
  metrics::Cell unfinished_ends_total;
  /// Times that accepting paused for a moment, since the system had no descriptor or no memory.
  metrics::Cell accept_pauses_total;
  /// Calls that were cancelled because the peer did not take their end.
  metrics::Cell finish_timeouts_total;
  /// Wakes that a queue's thread answered; one may stand for many.
  metrics::Cell wakes_total;
  /// Not a count: the local port from which the server last asked its own listener for a handshake,
  /// by which the door knows it; 0 before the first time.
  std::atomic<std::uint16_t> own_port{0};
};

}  // namespace uplink::transport
