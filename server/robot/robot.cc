#include "server/robot/robot.h"

#include <memory>
#include <utility>

#include "server/robot/mutation.h"

namespace uplink::robot {

Robot::Robot(storage::RobotRef id, SteadyTime server_started, const Clock& clock,
             const PresenceChanged& changed)
    : state(server_started, clock.Steady(), clock.System(),
            [this, &changed](Presence presence, SystemTime at) {
              if (changed) changed(this->id(), presence, at);
            }),
      clock_(clock),
      ruri_(id->ruri),
      id_(std::move(id)) {}

void Robot::OnHeld(const HoldNews& news) {
  state.BeginHold(news, clock_.Steady(), clock_.System());
}

StreamRef Robot::OnFenced(metrics::Ledger& ledger) {
  // First: whatever a stream still applies until it learns of this is not kept.
  if (!Planted(Mutation::kFenceKeepsState)) state.Lose();
  return sessions.OnFenced(ledger);
}

storage::RobotRef Robot::id() const {
  const std::lock_guard lock(mutex_);
  return id_;
}

void Robot::SetFleet(std::string_view fleet) {
  const std::lock_guard lock(mutex_);
  if (id_->fleet == fleet) return;
  id_ = std::make_shared<const model::RobotId>(
      model::RobotId{.ruri = ruri_, .fleet = std::string(fleet)});
}

}  // namespace uplink::robot
