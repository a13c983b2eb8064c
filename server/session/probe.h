#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <string_view>

#include <absl/status/status.h>

#include "metrics/cells.h"
#include "metrics/kinds.h"
#include "server/robot/held_back.h"
#include "storage/latest_kind.h"

namespace uplink::session {

/// How a stream ends: with one of gRPC's codes, by number, or broken without one. A closed list.
inline constexpr std::array<std::string_view, 18> kStreamEnds = {"ok",
                                                                 "cancelled",
                                                                 "unknown",
                                                                 "invalid_argument",
                                                                 "deadline_exceeded",
                                                                 "not_found",
                                                                 "already_exists",
                                                                 "permission_denied",
                                                                 "resource_exhausted",
                                                                 "failed_precondition",
                                                                 "aborted",
                                                                 "out_of_range",
                                                                 "unimplemented",
                                                                 "internal",
                                                                 "unavailable",
                                                                 "data_loss",
                                                                 "unauthenticated",
                                                                 "broken"};
inline constexpr std::size_t kStreamBroken = kStreamEnds.size() - 1;

/// Counts of sessions beside the ledger. Thread-safe; one for all sessions.
struct SessionProbe {
  metrics::Cell streams;
  metrics::Cell streams_total;
  metrics::Cell takeovers_total;
  metrics::Cell contested_total;
  metrics::Cell protocol_errors_total;
  /// Streams that were refused at their Hello: for lack of room for another robot, or because the
  /// certificate does not allow what the Hello asks for.
  metrics::Cell refused_full_total;
  metrics::Cell refused_identity_total;
  /// Streams of gateways that may bring in no more robots.
  metrics::Cell refused_gateway_total;
  /// Streams of robots that an operator blocked, or did not add.
  metrics::Cell refused_operator_total;
  /// A Hello was refused with this status.
  void CountRefusedHello(const absl::Status& status) {
    const bool identity = absl::IsUnauthenticated(status) || absl::IsPermissionDenied(status);
    (identity ? refused_identity_total : protocol_errors_total).Add();
  }
  /// Streams that were refused because too many of the robot's already waited.
  metrics::Cell refused_waiting_total;
  /// Streams that came too soon after others of their robot: those that wait now, and all that
  /// waited.
  metrics::Cell waiting;
  metrics::Cell delayed_total;
  metrics::CoreCell notices_total;
  metrics::CoreCell acks_total;
  /// Telemetry over the rate of its robot, superseded: by its place in metrics::kTelemetryKinds.
  std::array<metrics::CoreCell, metrics::kTelemetryKinds.size()> over_rate_total;
  metrics::Cell resumes_total;
  /// Streams whose frames are not read now, and how often that began.
  metrics::Cell held_back;
  metrics::Cell held_back_total;
  /// The same by robot::HeldBack, without kNone.
  std::array<metrics::Cell, robot::kHeldBackReasons> held_back_by;
  std::array<metrics::Cell, robot::kHeldBackReasons> held_back_by_total;
  metrics::Cell peer_stalls_total;
  metrics::Cell superseded_total;
  /// Pages of Rejects that were read for streams, and reads that failed.
  metrics::Cell reject_pages_total;
  metrics::Cell reject_reads_failed_total;
  /// Streams that ended with limits.unconfirmed_rejects_max unconfirmed Rejects.
  metrics::Cell unconfirmed_total;
  /// By storage::LatestKind: how often robots were asked for one, and streams whose robot was asked
  /// and has not answered.
  std::array<metrics::Cell, storage::kLatestKinds> resend_requests_total;
  std::array<metrics::Cell, storage::kLatestKinds> resend_unanswered;
  /// Streams that ended, by kStreamEnds.
  std::array<metrics::Cell, kStreamEnds.size()> ended_total;
  /// A stream ends with this code, or is broken off without one.
  void CountEnd(std::optional<absl::StatusCode> code) {
    const std::size_t end =
        code ? std::min(static_cast<std::size_t>(*code), kStreamBroken - 1) : kStreamBroken;
    ended_total[end].Add();
  }
  metrics::CoreCell frames_total;
  metrics::CoreCell frame_bytes_total;
  /// Time from the arrival of a durable message to the Ack that covers it.
  metrics::LatencyDistribution ack_seconds{metrics::kLatencyBoundsSeconds};
};

}  // namespace uplink::session
