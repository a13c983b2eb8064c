#pragma once

#include <algorithm>
#include <cstdint>

#include "schema/base/clock.h"

namespace uplink::mqtt {

/// When a PINGREQ is due, and when its PINGRESP is late. Pure.
///
/// A PINGREQ is due each interval, even if other packets are sent or come. The broker needs
/// something to be sent; a connection that only writes would not notice that its peer is gone; and
/// the PINGRESP, which queues behind messages in the broker, shows how far behind we are. It is
/// late if nothing at all came since the request and for `wait`: other bytes are a sign of life,
/// and the PINGRESP may be behind many of them. While we do not read, nothing is late; the wait
/// starts again when we read again.
///
/// Thread: confined to its connection's.
class Keepalive final {
 public:
  Keepalive(milliseconds interval, milliseconds wait, SteadyTime now)
      : interval_(interval), wait_(wait), sent_(now), heard_(now), asked_(now) {}

  /// The broker's interval (Server Keep Alive). It caps ours: 0, which means none, and longer ones
  /// leave ours, since we must notice in time that the broker is gone.
  void SetInterval(milliseconds interval) {
    if (interval.count() > 0) interval_ = std::min(interval_, interval);
  }
  [[nodiscard]] milliseconds interval() const { return interval_; }

  /// Bytes were sent; bytes were received.
  void Sent(SteadyTime now) { sent_ = now; }
  void NoteHeard(SteadyTime now) { heard_ = now; }
  void Pinged(SteadyTime now) {
    sent_ = now;
    asked_ = now;
    if (!waiting_) waited_since_ = now;
    waiting_ = true;
  }
  void Ponged() { waiting_ = false; }
  void StopReading() { reading_ = false; }
  void ReadAgain(SteadyTime now);

  /// How long the oldest PINGREQ has had no answer; zero while we do not read.
  [[nodiscard]] SteadyTime::duration Waited(SteadyTime now) const {
    return waiting_ && reading_ ? now - waited_since_ : SteadyTime::duration::zero();
  }

  enum class Due : std::uint8_t { kNothing, kPing, kLate };
  [[nodiscard]] Due At(SteadyTime now) const;
  /// When At may return something else.
  [[nodiscard]] SteadyTime Next() const;

 private:
  [[nodiscard]] SteadyTime PingAt() const;
  [[nodiscard]] SteadyTime LateAt() const;

  milliseconds interval_;
  const milliseconds wait_;
  SteadyTime sent_;
  SteadyTime heard_;
  SteadyTime asked_;
  SteadyTime waited_since_{};
  bool waiting_ = false;
  bool reading_ = true;
};

}  // namespace uplink::mqtt
