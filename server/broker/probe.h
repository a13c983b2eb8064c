#pragma once

#include <array>
#include <cstddef>

#include "metrics/cells.h"
#include "schema/cyberwave/topic_kinds.h"
#include "server/cyberwave/observed_counts.h"

namespace uplink::broker {

/// Counts of reading a broker, beside its messages (metrics::Ledger) and its connections
/// (mqtt::ClientProbe). Thread-safe.
struct BrokerProbe {
  /// Messages by the kind of their topic.
  std::array<metrics::Cell, cyberwave::kTopicKinds> topics;
  /// Records that messages brought.
  metrics::Cell records;
  /// Time from the arrival of a message with records to its PUBACK, or to its commit at QoS 0.
  metrics::LatencyDistribution ack_seconds{metrics::kLatencyBoundsSeconds};
  metrics::Cell pongs;
  /// Pings that came too often, or could not be answered.
  metrics::Cell pongs_withheld;
  /// How often a message waited for room in the journal, and 1 while one does.
  metrics::Cell held_back_total;
  metrics::Cell held_back;
  /// Messages of robots beyond cyberwave.robots_max, or limits.robots_max.
  metrics::Cell twins_refused;
  /// Streams whose robot another process adopted.
  metrics::Cell twins_lost;
  /// Streams of robots that are open.
  metrics::Cell streams;
  /// 1 while this process has the lease of its topics; how often it took it.
  metrics::Cell lease_held;
  metrics::Cell lease_taken;
  /// Unix time at which the certificate expires that the broker sees (NoteCertificate).
  metrics::Cell certificate_expiry_s;
  /// 1 while messages wait in the broker for us (broker_health.h).
  metrics::Cell behind;
};

}  // namespace uplink::broker
