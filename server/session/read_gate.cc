#include "server/session/read_gate.h"

namespace uplink::session {

void ReadGate::Request() {
  under_way_ = true;
  sources_.source.RequestRead();
}

void ReadGate::RequestUnless(HeldBack by, std::optional<SteadyTime> throttle_end) {
  SetReading(by == HeldBack::kNone ? Reading::kFlowing : Reading::kHeldBack);
  Tell(by);
  sources_.timers.Clear(Timer::kReadAgain);
  switch (by) {
    case HeldBack::kNone:
      return Request();
    case HeldBack::kInFlight:  // a commit of the robot wakes the stream
    case HeldBack::kUnread:    // a write that is done calls
      return;
    case HeldBack::kJournalShare:
    case HeldBack::kFlow:
    case HeldBack::kDisk:
      return;
    case HeldBack::kJournal:
      return sources_.robot.journal().WhenRoom(sources_.robot.self());
    case HeldBack::kMalformed:
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

void ReadGate::SetReading(Reading reading) {
  if (reading == Reading::kFlowing) Tell(HeldBack::kNone);
  if (reading_ == reading) return;
  reading_ = reading;
  const bool held_back = reading == Reading::kHeldBack;
  sources_.context.probe.held_back.Add(held_back ? 1 : -1);
  if (held_back) sources_.context.probe.held_back_total.Add();
  sources_.robot.robot().state.SetReading(reading, sources_.context.clock.Steady());
}

void ReadGate::Tell(HeldBack by) {
  if (told_ == by) return;
  told_ = by;
  sources_.robot.robot().sessions.SetHeldBack(by, sources_.context.clock.System());
}

}  // namespace uplink::session
