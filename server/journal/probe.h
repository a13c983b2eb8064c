#pragma once

#include <array>
#include <atomic>

#include "metrics/cells.h"
#include "schema/base/clock.h"
#include "schema/model/rejection.h"

namespace uplink::journal {

/// Metrics of the journals: one probe per server.
struct JournalProbe {
  metrics::LatencyDistribution commit_seconds{metrics::kLatencyBoundsSeconds};
  metrics::BatchDistribution commit_records{metrics::kBatchBounds};
  metrics::Cell store_errors;
  /// Journals whose last store call failed.
  metrics::Cell store_failing;
  /// Changes of presence that were committed, by model::Presence.
  std::array<metrics::Cell, 3> presence_changes;
  /// Changes of presence that the store refused because another process held the robot.
  metrics::Cell presence_refused;
  /// Connections of robots that were written; each several times.
  metrics::Cell connections_written;
  /// Connections of robots that were not written: too many waited for the store.
  metrics::Cell connections_dropped;
  /// Connections that were ended for a server that is over.
  metrics::Cell connections_ended;
  /// Robots for which the store, after a new connection, had less than it had confirmed.
  metrics::Cell went_back;
  /// When that was last found; the epoch if it never was. Any thread.
  std::atomic<SteadyTime> went_back_at{SteadyTime()};
  void NoteWentBack(SteadyTime now) {
    went_back.Add();
    went_back_at.store(now);
  }
  /// Robots whose holder was over and that this process adopted.
  metrics::Cell adopted;
  /// Open mission runs that the server closed: for their bound, and for their age.
  metrics::Cell runs_closed_for_bound;
  metrics::Cell runs_closed_for_age;
  /// Rows of quarantine that were deleted for their robot's bound; index: RejectReason.
  std::array<metrics::Cell, model::kRejectReasons + 1> quarantine_dropped;
  /// Shapes and objects that the sweep deleted.
  metrics::Cell expired_deleted;
  /// Rows, and partitions of days, that were deleted for their age.
  metrics::Cell history_deleted;
  /// Rejects that were kept when their quarantine row was deleted for its age.
  metrics::Cell rejects_kept;
  /// 1 while histories cannot be kept to their age.
  metrics::Cell retention_failing;
  /// Robots whose live state was checkpointed, once per checkpoint.
  metrics::Cell checkpoint_robots;
  /// Duration of a round of checkpoints, from its first row to its last.
  metrics::LatencyDistribution checkpoint_seconds{metrics::kLatencyBoundsSeconds};
  /// Journals that cannot write checkpoints although the store is there.
  metrics::Cell checkpoint_failing;
};

}  // namespace uplink::journal
