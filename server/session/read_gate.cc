#include "server/session/read_gate.h"

namespace uplink::session {

void ReadGate::Request() {
  under_way_ = true;
  sources_.source.RequestRead();
}

void ReadGate::RequestUnless(const Hold& hold) {
  SetReading(hold.none() ? Reading::kFlowing : Reading::kHeldBack);
  Tell(hold.by);
  sources_.timers.Clear(Timer::kReadAgain);
  if (hold.until) sources_.timers.Set(Timer::kReadAgain, *hold.until);
  switch (hold.by) {
    case HeldBack::kNone:
      return Request();
    case HeldBack::kJournal:
      return sources_.robot.WakeWhenRoom();
    case HeldBack::kInFlight:      // a commit of the robot wakes the stream
    case HeldBack::kJournalShare:  // as well
    case HeldBack::kUnread:        // a write that is done calls
    case HeldBack::kFlow:          // the timer calls
    case HeldBack::kDisk:
    case HeldBack::kMalformed:
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
  SessionProbe& probe = sources_.context.probe;
  if (told_ != HeldBack::kNone) probe.held_back_by[static_cast<std::size_t>(told_)].Add(-1);
  if (by != HeldBack::kNone) {
    probe.held_back_by[static_cast<std::size_t>(by)].Add();
    probe.held_back_by_total[static_cast<std::size_t>(by)].Add();
  }
  told_ = by;
  sources_.robot.robot().sessions.SetHeldBack(by, sources_.context.clock.System());
}

}  // namespace uplink::session
