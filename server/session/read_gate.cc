#include "server/session/read_gate.h"

namespace uplink::session {

void ReadGate::Request() {
  under_way_ = true;
  sources_.source.RequestRead();
}

void ReadGate::RequestUnless(HeldBack by, std::optional<SteadyTime> throttle_end) {
  SetHeld(by == HeldBack::kNone ? Held::kNo : Held::kYes);
  sources_.timers.Clear(Timer::kReadAgain);
  switch (by) {
    case HeldBack::kNone:
      return Request();
    case HeldBack::kInFlight:  // a commit of the robot wakes the stream
    case HeldBack::kOutgoing:  // a write that is done calls
      return;
    case HeldBack::kJournal:
      return sources_.robot.journal().WhenRoom(sources_.robot.self());
    case HeldBack::kThrottled:
      if (throttle_end) sources_.timers.Set(Timer::kReadAgain, *throttle_end);
      return;
  }
}

void ReadGate::WatchPeer(std::size_t outgoing) {
  if (outgoing < kOutgoingFramesMax) {
    sources_.timers.Clear(Timer::kStall);
  } else if (!sources_.timers.is_set(Timer::kStall)) {
    sources_.timers.Set(Timer::kStall, sources_.context.clock.Steady() + kPeerStallMax);
  }
}

void ReadGate::SetHeld(Held held) {
  if (held_ == held) return;
  held_ = held;
  const bool held_back = held == Held::kYes;
  sources_.context.probe.held_back.Add(held_back ? 1 : -1);
  if (held_back) sources_.context.probe.held_back_total.Add();
  sources_.robot.robot().state.SetReading(
      held_back ? robot::RobotState::Reading::kHeldBack : robot::RobotState::Reading::kFlowing,
      sources_.context.clock.Steady());
}

}  // namespace uplink::session
