#pragma once

#include <cstdint>
#include <optional>

#include "schema/base/backoff.h"
#include "schema/base/clock.h"
#include "server/mqtt/end_reason.h"

namespace uplink::mqtt {

/// Rules for reconnecting to a broker. A value; tests shorten it.
struct ReconnectLimits {
  BackoffLimits backoff{.first = milliseconds(500), .longest = std::chrono::seconds(30)};
  /// After a connection that lived so long, or that we ended for being behind, the next pause is a
  /// first one again.
  milliseconds early_within = std::chrono::seconds(30);
  /// After so many connections in a row that the broker ended sooner than that, without a reason,
  /// we assume that another client uses our id.
  int early_ends_max = 3;
  /// The pause while another client uses our id, plus up to a tenth, so that two servers that push
  /// each other out do not meet again.
  milliseconds taken_pause = std::chrono::seconds(60);
};

/// The pause before the next connection, by how the last one ended. Pure.
///
/// **Another client with our id.** A broker of MQTT 5 may report it (DISCONNECT 0x8E); with 3.1.1,
/// and mosquitto 2.0.11 with both, it closes the connection without a reason. So we assume it once
/// `early_ends_max` connections in a row were accepted and then ended without a reason before
/// `early_within`. A connection that failed in between restarts the count, since the broker was
/// away. A broker that fails in this way, or whose ACL closes connections, looks the same; the
/// status text names both.
///
/// Thread: confined to its client's.
class Reconnect final {
 public:
  explicit Reconnect(const ReconnectLimits& limits) : limits_(limits), backoff_(limits.backoff) {}

  struct Pause {
    milliseconds wait{0};
    bool id_taken = false;
  };
  /// `lived`: time since its CONNACK; empty if there was none. `random`: any evenly drawn number.
  [[nodiscard]] Pause After(EndReason reason, std::optional<milliseconds> lived,
                            std::uint64_t random);

 private:
  const ReconnectLimits limits_;
  Backoff backoff_;
  int early_ends_ = 0;
};

}  // namespace uplink::mqtt
