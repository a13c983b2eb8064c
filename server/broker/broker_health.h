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

/// Whether we learn what twins say: we are subscribed, and read in time.
///
/// Thread:  Update by the broker's; the rest by any, unless stated.
class BrokerHealth final {
 public:
  /// Both outlive it; `probe` shows whether we are behind.
  BrokerHealth(const Clock& clock, BrokerProbe& probe) : clock_(clock), probe_(probe) {}

  /// The state of the connections. A value.
  struct Connections {
    bool subscribed = false;
    std::size_t unacked_max = 0;
    /// Bytes of the live connection that the kernel holds unread. If there are many, we are too
    /// slow, and the broker drops further messages.
    std::size_t live_unread = 0;
    /// How long a ping of the live connection has had no answer. The answer queues behind the
    /// messages that wait in the broker.
    SteadyTime::duration live_ping_waited{0};
  };
  /// The broker calls it each second, and when a connection is subscribed or ends. `durable` has
  /// the counts of the durable connection.
  void Update(const Connections& connections, const mqtt::ClientProbe& durable);

  /// Every update of the last kLiveBehindMax found us behind with the live connection: its messages
  /// are too old to show which twins live. Thread: the broker's.
  [[nodiscard]] bool live_is_old() const;
  [[nodiscard]] fleet::Fleet::HearingState hearing() const;
  /// Empty while we are not subscribed.
  [[nodiscard]] std::optional<SystemTime> subscribed_since() const;

 private:
  /// What changed since the last update. A value.
  struct Progress {
    /// Messages came.
    bool read = false;
    /// Reading is stopped, or messages wait for their acks and none was acked.
    bool stopped = false;
    /// Reading stopped at some time since, or the window is full: messages may wait in the broker.
    bool behind = false;
  };
  [[nodiscard]] Progress NoteProgress(const mqtt::ClientProbe& durable,
                                      const Connections& connections);

  const Clock& clock_;
  BrokerProbe& probe_;
  /// Counts of the durable connection at the last update.
  std::int64_t messages_then_ = 0;
  std::int64_t stops_then_ = 0;
  std::int64_t pubacks_then_ = 0;
  /// Since when reading is stopped and nothing came, and since when each update found us behind.
  std::optional<SteadyTime> unread_since_;
  std::optional<SteadyTime> behind_since_;
  std::optional<SteadyTime> live_behind_since_;
  /// The last update at which live_is_old.
  std::optional<SteadyTime> live_old_at_;
  /// The last update at which we were not behind; the epoch while we are not subscribed.
  std::atomic<SteadyTime> heard_at_{SteadyTime()};
  mutable std::mutex mutex_;
  std::optional<SystemTime> subscribed_since_;
};

/// Why the live connection ends once BrokerHealth::live_is_old.
[[nodiscard]] mqtt::End BehindEnd();

}  // namespace uplink::broker
