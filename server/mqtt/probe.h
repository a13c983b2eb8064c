#pragma once

#include <array>

#include "metrics/cells.h"
#include "server/mqtt/end_reason.h"

namespace uplink::mqtt {

/// The counts of one client. Thread-safe; it outlives its client.
struct ClientProbe {
  /// Connections that a broker accepted, and 1 while one is open.
  metrics::Cell accepted;
  metrics::Cell connected;
  /// Connections, and attempts, that ended, by EndReason.
  std::array<metrics::Cell, kEndReasonNames.size()> ended;
  /// PUBLISHes that were given to the core, by QoS; the next six count parts of them.
  std::array<metrics::Cell, 2> messages;
  /// The broker marked it as possibly sent before.
  metrics::Cell dups;
  /// This connection had delivered it before; and those of them that it had acked too.
  metrics::Cell redelivered;
  metrics::Cell crossed;
  metrics::Cell retained;
  /// The payload or the head was over its bound, and skipped.
  metrics::Cell oversized;
  /// The topic was invalid.
  metrics::Cell bad_topics;
  /// Bytes of payloads, skipped ones included; for a too large head, the bytes of the whole packet.
  metrics::Cell payload_bytes;
  /// PUBACKs that were given to a connection.
  metrics::Cell pubacks;
  /// Releases of a delivery by an older connection, which do nothing.
  metrics::Cell releases_late;
  /// PUBLISHes at QoS 1 that wait for their release.
  metrics::Cell unacked;
  /// How often reading stopped because the window was full; and 1 while that lasts, while the
  /// broker does not take what we write, and while the core stopped reading.
  metrics::Cell window_stops;
  metrics::Cell stopped_by_window;
  metrics::Cell stopped_by_output;
  metrics::Cell stopped_by_core;
  /// Our PUBLISHes that were given to a connection, and those that were dropped: no connection, no
  /// room, or too large for the broker.
  metrics::Cell published;
  metrics::Cell publishes_dropped;
  /// SUBACKs that refused a filter or gave a lower QoS, and filters for which that holds now.
  metrics::Cell refusals;
  metrics::Cell lower_grants;
  metrics::Cell filters_refused;
  metrics::Cell filters_lower;
  /// The broker had lost our kept session.
  metrics::Cell sessions_lost;
  /// Connections whose session the broker keeps for less time than we asked for.
  metrics::Cell sessions_short;
  /// How often we concluded that another client uses our id; and 1 from then until a broker accepts
  /// us, a connection ends for another reason, or we stop.
  metrics::Cell ids_taken;
  metrics::Cell id_taken;

  void CountEnd(EndReason reason) { ended[static_cast<std::size_t>(reason)].Add(); }
};

}  // namespace uplink::mqtt
