#pragma once

#include "tools/uplink-fleet/robot/behaviour/facts.h"
#include "tools/uplink-fleet/robot/behaviour/seeded.h"

namespace uplink::synthetic {

/// A battery that drains while the robot works and charges when it is low; its voltage, current and
/// charge fit its level. It says so in a message when it goes to charge and when it is back.
class Battery final {
 public:
  explicit Battery(Seeded random);

  void Advance(const Moment& moment, Facts& facts, Outbox& out);
  [[nodiscard]] model::BatteryStatus Status(const Facts& facts) const;

 private:
  double soc_pct_;
  double current_a_ = 0;
};

}  // namespace uplink::synthetic
