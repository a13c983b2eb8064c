#include "tools/uplink-fleet/robot/behaviour/controls.h"

namespace uplink::synthetic {
namespace {

/// Mean seconds between.
constexpr double kBetweenStopsS = 60;
constexpr double kBetweenTeleopS = 45;

}  // namespace

void Controls::Advance(const Moment& moment, Facts& facts, Outbox& out) {
  if (facts.estop) {
    engaged_s_ -= moment.dt_s;
    if (engaged_s_ <= 0) {
      facts.estop = false;
      estop_ = {.unix_time_ms = moment.now_ms, .active = false, .ids = {}};
      out.emplace_back(model::EventTelemetry{moment.now_ms, model::EstopReleasedEvent{}});
    }
  } else if (random_.Chance(moment.dt_s / kBetweenStopsS)) {
    facts.estop = true;
    engaged_s_ = random_.Between(2, 6);
    estop_ = {.unix_time_ms = moment.now_ms, .active = true, .ids = {"front"}};
    if (random_.Chance(0.3)) estop_.ids.emplace_back("remote");
    out.emplace_back(model::EventTelemetry{moment.now_ms, model::EstopEngagedEvent{}});
  }
  steered_s_ -= moment.dt_s;
  if (steered_s_ <= 0 && random_.Chance(moment.dt_s / kBetweenTeleopS)) {
    steered_s_ = random_.Between(3, 10);
  }
  const model::RobotMode mode = facts.charging   ? model::RobotMode::kIdle
                                : steered_s_ > 0 ? model::RobotMode::kTeleop
                                                 : model::RobotMode::kAuto;
  if (mode == facts.mode) return;
  out.emplace_back(model::EventTelemetry{moment.now_ms,
                                         model::ModeChangedEvent{.from = facts.mode, .to = mode}});
  facts.mode = mode;
}

}  // namespace uplink::synthetic
