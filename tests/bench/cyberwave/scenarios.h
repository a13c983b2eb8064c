#pragma once

#include <string>
#include <vector>

#include "schema/base/clock.h"
#include "tests/bench/figures.h"

namespace uplink::bench {

/// How a scenario is measured. A value.
struct CyberwaveRun {
  const Clock& clock;
  /// A migrated PostgreSQL database that no other server uses.
  std::string postgres_url;
  int rounds = 3;
  int seconds = 5;
};

// Each returns its rows. Broker and publishers have one core, who reads the broker has the other,
// PostgreSQL either. Every reader has a broker and publishers of its own, which rest while another
// one is measured.

/// Flat joints of six at QoS 0, 20,000 per second of 500 twins: the reader's CPU for each, beside
/// a bare sink and an exporter.
[[nodiscard]] std::vector<Row> MeasureJoints(const CyberwaveRun& run);
/// Events at QoS 1 with a backlog in the broker: how many per second are committed and acked,
/// beside a sink that acks at once.
[[nodiscard]] std::vector<Row> MeasureEvents(const CyberwaveRun& run);
/// One event at a time on an idle server: from PUBLISH to PUBACK on the wire, beside a bare commit.
[[nodiscard]] std::vector<Row> MeasureAcks(const CyberwaveRun& run);
/// Depth frames of 800 KB, 30 per second: what they add to an idle server that counts media, and to
/// one that does not.
[[nodiscard]] std::vector<Row> MeasureDepth(const CyberwaveRun& run);

}  // namespace uplink::bench
