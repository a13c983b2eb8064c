#include "server/session/read_gate.h"

namespace uplink::session {

void ReadGate::Request() {
  under_way_ = true;
  parts_.source.RequestRead();
}

void ReadGate::RequestUnless(Hold hold, std::optional<SteadyTime> throttle_end) {
  SetHeld(hold == Hold::kNone ? Held::kNo : Held::kYes);
  parts_.timers.Clear(Timer::kReadAgain);
  switch (hold) {
    case Hold::kNone:
      return Request();
    case Hold::kInFlight:  // a commit of the robot wakes the stream
    case Hold::kOutgoing:  // a write that is done calls
      return;
    case Hold::kJournal:
      return parts_.robot.journal().WhenRoom(parts_.robot.self());
    case Hold::kThrottled:
      if (throttle_end) parts_.timers.Set(Timer::kReadAgain, *throttle_end);
      return;
  }
}

void ReadGate::WatchPeer(std::size_t outgoing) {
  if (outgoing < kOutgoingFramesMax) {
    parts_.timers.Clear(Timer::kStall);
  } else if (!parts_.timers.is_set(Timer::kStall)) {
    parts_.timers.Set(Timer::kStall, parts_.context.clock.Steady() + kPeerStallMax);
  }
}

void ReadGate::SetHeld(Held held) {
  if (held_ == held) return;
  held_ = held;
  const bool held_back = held == Held::kYes;
  parts_.context.probe.held_back.Add(held_back ? 1 : -1);
  if (held_back) parts_.context.probe.held_back_total.Add();
  parts_.robot.robot().state.SetReading(
      held_back ? robot::RobotState::Reading::kHeldBack : robot::RobotState::Reading::kFlowing,
      parts_.context.clock.Steady());
}

}  // namespace uplink::session
