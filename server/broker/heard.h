#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <optional>

#include "schema/base/clock.h"
#include "server/broker/probe.h"
#include "server/fleet/fleet.h"
#include "server/mqtt/probe.h"

namespace uplink::broker {

/// Whether what twins say comes to our knowledge: we are subscribed, and read.
///
/// Thread:  Look by the broker's; the rest by any.
class Heard final {
 public:
  /// Both outlive it; `probe` shows whether we read.
  Heard(const Clock& clock, BrokerProbe& probe) : clock_(clock), probe_(probe) {}

  /// To be called each second, and when a connection ends. `durable` counts for the connection
  /// whose messages may stay unread.
  void Look(bool subscribed, const mqtt::ClientProbe& durable, std::size_t unacked_max);

  [[nodiscard]] fleet::Fleet::Hearing hearing() const;
  /// Nothing while we are not subscribed.
  [[nodiscard]] std::optional<SystemTime> subscribed_since() const;

 private:
  /// Nothing was read for a while.
  [[nodiscard]] bool IsUnread(const mqtt::ClientProbe& durable);
  /// Reading stopped since the last look, or the window is full: what the broker has may lie there
  /// for longer.
  [[nodiscard]] bool IsBehind(const mqtt::ClientProbe& durable, std::size_t unacked_max);

  const Clock& clock_;
  BrokerProbe& probe_;
  /// Messages of the durable connection as of the last look, and since when none came.
  std::int64_t messages_then_ = 0;
  std::optional<SteadyTime> unread_since_;
  std::int64_t stops_then_ = 0;
  std::int64_t pubacks_then_ = 0;
  /// Messages wait for their acks, and none was acked since the look before.
  bool stuck_ = false;
  std::optional<SteadyTime> behind_since_;
  /// The last look at which all was heard; the epoch while we are not subscribed.
  std::atomic<SteadyTime> heard_at_{SteadyTime()};
  mutable std::mutex mutex_;
  std::optional<SystemTime> subscribed_since_;
};

}  // namespace uplink::broker
