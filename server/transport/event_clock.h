#pragma once

#include <optional>

#include "schema/base/clock.h"

namespace uplink::transport {

/// The time at the event that a queue handles: read once, whatever asks for it while the event
/// lasts. A system call's worth for each message otherwise.
///
/// Thread: confined to the queue's thread, as are the sessions that it is given to.
class EventClock final : public Clock {
 public:
  explicit EventClock(const Clock& clock) : clock_(clock), steady_(clock.Steady()) {}

  /// Another event begins now.
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
  /// Asked for by few events.
  mutable std::optional<SystemTime> system_;
};

}  // namespace uplink::transport
