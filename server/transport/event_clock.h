#pragma once

#include <optional>

#include "schema/base/clock.h"

namespace uplink::transport {

/// The time of the event that a queue handles. It is read once per event, which saves about a
/// system call for each message.
///
/// Thread: confined to the queue's thread, as are the sessions that it is given to.
class EventClock final : public Clock {
 public:
  explicit EventClock(const Clock& clock) : clock_(clock), steady_(clock.Steady()) {}

  /// The next event begins now.
  void Advance() {
    steady_ = clock_.Steady();
    system_.reset();
  }

  [[nodiscard]] SteadyTime Steady() const override { return steady_; }
  [[nodiscard]] SystemTime System() const override {
    if (!system_) system_ = clock_.System();
    return *system_;
  }

 private:
  const Clock& clock_;
  SteadyTime steady_;
  /// Read when it is first needed: few events do.
  mutable std::optional<SystemTime> system_;
};

}  // namespace uplink::transport
