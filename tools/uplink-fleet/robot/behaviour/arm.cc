#include "tools/uplink-fleet/robot/behaviour/arm.h"

#include <algorithm>
#include <cmath>

namespace uplink::synthetic {
namespace {

constexpr std::array<const char*, kArmJoints> kNames = {
    "shoulder_pan", "shoulder_lift", "elbow_flex", "wrist_flex", "wrist_roll", "lift"};
constexpr std::size_t kPrismatic = kArmJoints - 1;
constexpr double kVoltsEmpty = 12.0;
constexpr double kVoltsAPercent = 0.028;
constexpr std::int64_t kMicrosAMilli = 1000;
constexpr double kMillisPerSecond = 1000;

/// To a thousandth: what a sensor says, and a text that is the same again when it is read; so no
/// zero with a sign, which JSON readers lose.
double Rounded(double value) { return std::round(value * 1000) / 1000 + 0.0; }

}  // namespace

Arm::Arm(Seeded random) {
  for (std::size_t i = 0; i < swings_.size(); ++i) {
    const bool lifts = i == kPrismatic;
    swings_[i] = {.amplitude = lifts ? random.Between(0.05, 0.4) : random.Between(0.3, 1.5),
                  .radians_per_s = random.Between(0.2, 1.2),
                  .phase = random.Between(0, 6)};
  }
}

void Arm::Advance(const Moment& moment, const Facts& facts) {
  up_s_ += moment.dt_s;
  if (!facts.estop) moved_s_ += moment.dt_s;
}

model::RcanJoint Arm::Joint(std::size_t index, bool moves) const {
  const Swing& swing = swings_[index];
  const double angle = swing.phase + swing.radians_per_s * moved_s_;
  const double position = Rounded(swing.amplitude * std::sin(angle));
  const double velocity =
      moves ? Rounded(swing.amplitude * swing.radians_per_s * std::cos(angle)) : 0;
  model::RcanJoint joint;
  joint.joint = kNames[index];
  if (index == kPrismatic) {
    joint.position_m = position;
    joint.velocity_m_s = velocity;
  } else {
    joint.position_rad = position;
    joint.velocity_rad_s = velocity;
  }
  joint.effort_nm = Rounded(0.4 * std::sin(angle + 1));
  joint.temperature_c = Rounded(32 + 8 * std::abs(std::sin(angle / 7)));
  joint.error_flags = moves ? 0 : 1;
  joint.timestamp_us = last_us_;
  return joint;
}

model::RcanState Arm::State(const Moment& moment, const Facts& facts) {
  last_us_ = std::max(moment.now_ms * kMicrosAMilli, last_us_ + 1);
  model::RcanState state;
  state.seq = ++seq_;
  state.uptime_ms = static_cast<std::int64_t>(up_s_ * kMillisPerSecond);
  state.battery_pct = static_cast<std::int64_t>(std::clamp(facts.soc_pct, 0.0, 100.0));
  state.battery_v = Rounded(kVoltsEmpty + kVoltsAPercent * facts.soc_pct);
  state.position = model::RcanPosition{.x_m = Rounded(0.1 * std::sin(moved_s_)),
                                       .y_m = Rounded(0.1 * std::cos(moved_s_)),
                                       .heading_rad = Rounded(std::sin(moved_s_ / 3))};
  for (std::size_t i = 0; i < kArmJoints; ++i) state.joints.push_back(Joint(i, !facts.estop));
  state.clock_source = "ntp";
  state.timestamp_us = last_us_;
  return state;
}

}  // namespace uplink::synthetic
