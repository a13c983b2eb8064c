#include "server/session/read_gate.h"

namespace uplink::session {

void ReadGate::Request() {
  under_way_ = true;
  sources_.source.RequestRead();
}

void ReadGate::RequestUnless(const ingest::Block& block) {
  SetReading(block.none() ? Reading::kFlowing : Reading::kHeldBack);
  Tell(block.by);
  sources_.timers.Clear(Timer::kReadAgain);
  if (block.until) sources_.timers.Set(Timer::kReadAgain, *block.until);
  switch (block.by) {
    case robot::HeldBack::kNone:
      return Request();
    case robot::HeldBack::kJournal:
      return sources_.robot.WakeWhenRoom();
    case robot::HeldBack::kInFlight:      // a commit of the robot wakes the stream
    case robot::HeldBack::kJournalShare:  // as well
    case robot::HeldBack::kUnread:        // a write that is done calls
    case robot::HeldBack::kFlow:          // the timer calls
    case robot::HeldBack::kDisk:
    case robot::HeldBack::kMalformed:
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
  if (reading == Reading::kFlowing) Tell(robot::HeldBack::kNone);
  if (reading_ == reading) return;
  reading_ = reading;
  const bool held_back = reading == Reading::kHeldBack;
  sources_.context.probe.held_back.Add(held_back ? 1 : -1);
  if (held_back) sources_.context.probe.held_back_total.Add();
  sources_.robot.robot().state.SetReading(reading, sources_.context.clock.Steady());
}

void ReadGate::Tell(robot::HeldBack by) {
  if (told_ == by) return;
  SessionProbe& probe = sources_.context.probe;
  if (told_ != robot::HeldBack::kNone) probe.held_back_by[static_cast<std::size_t>(told_)].Add(-1);
  if (by != robot::HeldBack::kNone) {
    probe.held_back_by[static_cast<std::size_t>(by)].Add();
    probe.held_back_by_total[static_cast<std::size_t>(by)].Add();
  }
  const SteadyTime now = sources_.context.clock.Steady();
  if (told_ == robot::HeldBack::kNone) held_back_since_ = now;
  if (by == robot::HeldBack::kNone) {
    held_back_total_ += now - held_back_since_;
  } else {
    held_back_last_ = by;
  }
  told_ = by;
  sources_.robot.robot().sessions.SetHeldBack(by, sources_.context.clock.System());
}

}  // namespace uplink::session
