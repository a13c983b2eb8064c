#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <optional>

#include "schema/base/clock.h"
#include "server/broker/probe.h"
#include "server/fleet/fleet.h"
#include "server/mqtt/end_reason.h"
#include "server/mqtt/probe.h"

namespace uplink::broker {

/// Whether what twins say comes to our knowledge: we are subscribed, and read.
///
/// Thread:  Look by the broker's; the rest by any, where nothing else is said.
class Heard final {
 public:
  /// Both outlive it; `probe` shows whether we read.
  Heard(const Clock& clock, BrokerProbe& probe) : clock_(clock), probe_(probe) {}

  /// Where the connections stand. A value.
  struct Standing {
    bool subscribed = false;
    std::size_t unacked_max = 0;
    /// Bytes of the live connection that wait in the system. Where many do, we are too slow, and
    /// the broker drops what else is for us.
    std::size_t live_unread = 0;
    /// How long a ping of the live connection has no answer, which stands behind what waits.
    SteadyTime::duration live_ping_waited{0};
  };
  /// To be called each second, and when a connection is subscribed or ends. `durable` counts for
  /// the connection whose messages may stay unread.
  void Look(const Standing& standing, const mqtt::ClientProbe& durable);

  /// Each look of kLiveBehindMax found us behind with the live connection: what it brings is too
  /// old to tell who lives. Thread: the broker's.
  [[nodiscard]] bool live_is_old() const;
  [[nodiscard]] fleet::Fleet::HearingState hearing() const;
  /// Nothing while we are not subscribed.
  [[nodiscard]] std::optional<SystemTime> subscribed_since() const;

 private:
  /// What changed since the last look. A value.
  struct Progress {
    /// Messages came.
    bool read = false;
    /// Nothing may be read now, or messages wait for their acks and none was acked.
    bool stopped = false;
    /// Reading stopped at some time since, or the window is full: what the broker has may lie there
    /// for longer.
    bool behind = false;
  };
  [[nodiscard]] Progress NoteProgress(const mqtt::ClientProbe& durable, const Standing& standing);

  const Clock& clock_;
  BrokerProbe& probe_;
  /// Of the durable connection, as of the last look.
  std::int64_t messages_then_ = 0;
  std::int64_t stops_then_ = 0;
  std::int64_t pubacks_then_ = 0;
  /// Since when reading is stopped and nothing came, and since when each look found us behind.
  std::optional<SteadyTime> unread_since_;
  std::optional<SteadyTime> behind_since_;
  std::optional<SteadyTime> live_behind_since_;
  /// The last look at which live_is_old.
  std::optional<SteadyTime> live_old_at_;
  /// The last look at which all was heard; the epoch while we are not subscribed.
  std::atomic<SteadyTime> heard_at_{SteadyTime()};
  mutable std::mutex mutex_;
  std::optional<SystemTime> subscribed_since_;
};

/// Of the live connection, once Heard::live_is_old.
[[nodiscard]] mqtt::End BehindEnd();

}  // namespace uplink::broker
