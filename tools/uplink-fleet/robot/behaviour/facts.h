#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "schema/model/motion.h"
#include "schema/model/record.h"
#include "schema/model/status.h"

namespace uplink::synthetic {

/// One step of a robot's life.
struct Moment {
  /// Unix; what the robot's own clock shows.
  std::int64_t now_ms = 0;
  /// Since the step before, as the robot lives it: pace makes it longer than the clock's.
  double dt_s = 0;
};

/// The part of a robot's state that its behaviours share. A value.
struct Facts {
  model::Pose pose;
  double speed_mps = 0;
  double turn_rps = 0;
  /// Driven in all.
  double distance_m = 0;
  double driven_s = 0;

  double soc_pct = 100;
  bool charging = false;
  std::uint32_t charge_cycles = 0;

  bool estop = false;
  model::RobotMode mode = model::RobotMode::kAuto;
  bool faulted = false;

  bool mission_active = false;
  std::string mission_name;
  std::uint32_t missions_done = 0;

  [[nodiscard]] bool may_drive() const { return !estop && !charging; }
};

/// Where behaviours put what to send, in order.
using Outbox = std::vector<model::Body>;

}  // namespace uplink::synthetic
