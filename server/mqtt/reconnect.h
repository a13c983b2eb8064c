#pragma once

#include <cstdint>
#include <optional>

#include "schema/base/backoff.h"
#include "schema/base/clock.h"
#include "server/mqtt/end_reason.h"

namespace uplink::mqtt {

/// When we come back to a broker. A value; tests shorten it.
struct ReconnectLimits {
  BackoffLimits backoff{.first = milliseconds(500), .longest = std::chrono::seconds(30)};
  /// A connection that lived so long, or that we ended for being behind, was a good one: the next
  /// pause is a first one again.
  milliseconds soon = std::chrono::seconds(30);
  /// Connections in a row that the broker ended sooner than that, without a word, after which
  /// another client is taken to use our id.
  int soon_ends_max = 3;
  /// The pause while another client uses our id, and up to a tenth more, so that two servers which
  /// push each other out do not meet again.
  milliseconds taken_pause = std::chrono::seconds(60);
};

/// The pause before the next connection, from how the last one ended. Pure.
///
/// **When another client took our id.** A broker of MQTT 5 may say so (DISCONNECT 0x8E); by 3.1.1,
/// and with mosquitto 2.0.11 by both, it closes the connection without a word. So we take it that
/// somebody has our id once `soon_ends_max` connections in a row were accepted and then ended
/// without a reason before `soon`. One that could not be made in between begins the count anew:
/// then the broker was away. A broker that fails so itself is treated the same, and so is an ACL of
/// a broker that closes; the text of the status names both.
///
/// Thread: confined to its client's.
class Reconnect final {
 public:
  explicit Reconnect(const ReconnectLimits& limits) : limits_(limits), backoff_(limits.backoff) {}

  struct Pause {
    milliseconds wait{0};
    bool id_taken = false;
  };
  /// `lived`: since its CONNACK; nothing if none accepted us. `random`: any evenly drawn number.
  [[nodiscard]] Pause After(EndReason reason, std::optional<milliseconds> lived,
                            std::uint64_t random);

 private:
  const ReconnectLimits limits_;
  Backoff backoff_;
  int soon_ends_ = 0;
};

}  // namespace uplink::mqtt
