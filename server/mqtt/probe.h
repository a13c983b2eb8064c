#pragma once

#include <array>

#include "metrics/cells.h"
#include "server/mqtt/end_reason.h"

namespace uplink::mqtt {

/// What one client counts. Thread-safe; it outlives its client.
struct ClientProbe {
  /// Connections that a broker accepted, and 1 while one is open.
  metrics::Cell accepted;
  metrics::Cell connected;
  /// Connections, and attempts, that ended, by EndReason.
  std::array<metrics::Cell, kEndReasonNames.size()> ended;
  /// PUBLISHes that were given to the core, by QoS; each of the next six is part of them.
  std::array<metrics::Cell, 2> messages;
  /// The broker said that it may have sent it before.
  metrics::Cell dups;
  /// This connection had delivered it before; and those of them that it had acked too.
  metrics::Cell redelivered;
  metrics::Cell crossed;
  metrics::Cell retained;
  /// The payload or the head was over its bound, and read past.
  metrics::Cell oversized;
  /// The topic was none.
  metrics::Cell bad_topics;
  /// Of payloads, those read past included; of what a too large head belongs to, all.
  metrics::Cell payload_bytes;
  /// PUBACKs that were given to a connection.
  metrics::Cell pubacks;
  /// Releases of a delivery by an older connection, which do nothing.
  metrics::Cell releases_late;
  /// PUBLISHes at QoS 1 that wait for their release.
  metrics::Cell unacked;
  /// Times that reading stopped because the window was full, and 1 while it does, while the broker
  /// does not take what we write, or while the core asked for it.
  metrics::Cell window_stops;
  metrics::Cell stopped_by_window;
  metrics::Cell stopped_by_output;
  metrics::Cell stopped_by_core;
  /// PUBLISHes of ours that were given to a connection, and those that were not: nobody was
  /// connected, no room, too large for the broker.
  metrics::Cell published;
  metrics::Cell publishes_dropped;
  /// SUBACKs that refused a filter or gave a lower QoS, and filters of which that holds now.
  metrics::Cell refusals;
  metrics::Cell lower_grants;
  metrics::Cell filters_refused;
  metrics::Cell filters_lower;
  /// A kept session that we had was gone.
  metrics::Cell sessions_lost;
  /// Connections whose session the broker keeps for less time than it was asked to.
  metrics::Cell sessions_short;
  /// Times that another client was taken to use our id, and 1 from then until a broker accepts us,
  /// a connection ends for another reason, or we stop.
  metrics::Cell ids_taken;
  metrics::Cell id_taken;

  void CountEnd(EndReason reason) { ended[static_cast<std::size_t>(reason)].Add(); }
};

}  // namespace uplink::mqtt
