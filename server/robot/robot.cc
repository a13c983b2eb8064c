#include "server/robot/robot.h"

#include <memory>
#include <utility>

#include "server/robot/mutation.h"
#include "server/robot/source_of.h"

namespace uplink::robot {

Robot::Robot(storage::RobotRef id, SteadyTime server_started, const Clock& clock,
             const PresenceChanged& changed)
    : state(server_started, clock.Steady(), clock.System(),
            [this, &changed](const storage::StoredPresence& now,
                             std::optional<model::ConnectionEnd> why) {
              if (changed) changed(this->id(), now, why);
            }),
      sessions(SourceOf(id->ruri)),
      clock_(clock),
      ruri_(id->ruri),
      id_(std::move(id)) {}

void Robot::NoteHeard(SystemTime at) {
  const std::int64_t at_ms = UnixMs(at);
  std::int64_t known = heard_at_ms_.load();
  while (known < at_ms && !heard_at_ms_.compare_exchange_weak(known, at_ms)) {
  }
}

bool Robot::BeginLeaving(LeaveWhen when) {
  if (when == LeaveWhen::kAtOnce) leaves_at_once_.store(true);
  Leaving stays = Leaving::kNo;
  return leaving_.compare_exchange_strong(stays, Leaving::kAsked);
}

bool Robot::Stay() {
  leaves_at_once_.store(false);
  return leaving_.exchange(Leaving::kNo) != Leaving::kNo;
}

bool Robot::MayLeave() const {
  if (leaving_.load() != Leaving::kAsked || !idle()) return false;
  return leaves_at_once_.load() || state.presence() != Presence::kOnline;
}

void Robot::OnLeft() {
  Leaving asked = Leaving::kAsked;
  leaving_.compare_exchange_strong(asked, Leaving::kLeft);
}

void Robot::OnHeld(const HoldNews& news) {
  // It came for a stream that had ended: the journal must let go of the robot once more.
  Leaving left = Leaving::kLeft;
  leaving_.compare_exchange_strong(left, Leaving::kAsked);
  state.BeginHold(news, clock_.Steady(), clock_.System());
}

void Robot::OnHeldElsewhere(const std::optional<storage::StoredPresence>& presence) {
  // The holder may be known already. A stream here is about to take the robot from it.
  if (state.foreign()) return;
  state.FollowHolder(
      {}, presence.value_or(storage::StoredPresence{Presence::kUnknown, state.presence_since()}));
}

loop::StreamRef Robot::OnFenced(metrics::Ledger& ledger) {
  // First, so that nothing a stream applies before it learns of this is kept.
  if (!Planted(Mutation::kFenceKeepsState)) state.Lose();
  return sessions.OnFenced(ledger);
}

loop::StreamRef Robot::OnRefused(metrics::Ledger& ledger) {
  state.Lose();
  return sessions.OnRefused(ledger);
}

loop::StreamRef Robot::OnWentBack(metrics::Ledger& ledger) {
  // The last checkpoints may be gone, too.
  state.PutBackChanges(LivePartSet().set());
  return sessions.OnWentBack(ledger);
}

loop::StreamRef Robot::OnOtherFleet(std::uint64_t open_id, const std::string& fleet,
                                    metrics::Ledger& ledger) {
  const auto refused = sessions.OnOtherFleet(open_id, ledger);
  if (!refused) return {};
  Disown(refused->claimed, fleet);
  return refused->stream;
}

void Robot::Disown(std::string_view claimed, std::string_view actual) {
  // The live data here. If this process holds the robot, that is not all of its live data.
  if (state.held_since() == 0) {
    state.Lose();
    state.FollowHolder({}, {Presence::kUnknown, clock_.System()});
  }
  // A certificate that names the robot may have moved it meanwhile.
  MoveFleet(claimed, actual);
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

void Robot::SetSpeaker(std::string_view gateway) {
  const std::lock_guard lock(mutex_);
  speaker_ = gateway;
}

std::optional<std::string> Robot::speaker() const {
  const std::lock_guard lock(mutex_);
  return speaker_;
}

void Robot::MoveFleet(std::string_view from, std::string_view to) {
  const std::lock_guard lock(mutex_);
  if (id_->fleet != from) return;
  id_ = std::make_shared<const model::RobotId>(
      model::RobotId{.ruri = ruri_, .fleet = std::string(to)});
}

}  // namespace uplink::robot
