#pragma once

#include "tools/uplink-fleet/robot/behaviour/facts.h"
#include "tools/uplink-fleet/robot/behaviour/seeded.h"

namespace uplink::synthetic {

/// Somebody at the robot: presses the emergency stop now and then and releases it, and takes over
/// by remote control; each change is an event.
class Controls final {
 public:
  explicit Controls(Seeded random) : random_(random) {}

  void Advance(const Moment& moment, Facts& facts, Outbox& out);
  [[nodiscard]] model::EStop EStop() const { return estop_; }

 private:
  Seeded random_;
  model::EStop estop_;
  /// Seconds until the present state ends; the stop is engaged, or somebody steers.
  double engaged_s_ = 0;
  double steered_s_ = 0;
};

}  // namespace uplink::synthetic
