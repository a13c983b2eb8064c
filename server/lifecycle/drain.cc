#include "server/lifecycle/drain.h"

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <utility>

#include "server/lifecycle/deadline.h"

namespace uplink::lifecycle {
namespace {

/// How often a drain looks whether the journal is empty.
constexpr milliseconds kIdleLook{10};
/// What the end of a drain has at least for what waits, however long the streams took.
constexpr std::chrono::seconds kLastWrites{2};

}  // namespace

Drain::Drain(Parts parts) : parts_(std::move(parts)) {}

void Drain::Run() {
  const SteadyTime deadline = parts_.clock.Steady() + parts_.timeout;
  parts_.logger.Info("draining", {{"streams", parts_.transport.streams()},
                                  {"timeout_ms", parts_.timeout.count()}});
  parts_.monitor.BeginDrain();
  parts_.journals.RequestCheckpoint();
  const Deadline last(parts_.timeout + kStopWait, [this] { EndUnfinished(); });
  parts_.transport.drain(parts_.timeout);
  if (!parts_.transport.wait_for_streams(parts_.timeout)) {
    parts_.logger.Warn("streams_left", {{"streams", parts_.transport.streams()}});
  }
  EndPresence();
  parts_.journals.RequestCheckpoint();
  WaitForJournals(deadline);
  parts_.stop();
  const std::int64_t unsettled = parts_.ledgers.Sum().uplinks.in_flight;
  if (unsettled == 0) {
    parts_.logger.Info("stopped");
  } else {
    parts_.logger.Warn("stopped_unsettled", {{"uplinks", unsettled}});
  }
}

void Drain::EndPresence() {
  for (const robot::Robot* robot : parts_.fleet.Sorted()) {
    if (robot->state.presence() == model::Presence::kUnknown) continue;
    parts_.journals.NotePresence(robot->id(), model::Presence::kUnknown, parts_.clock.System());
  }
}

void Drain::WaitForJournals(SteadyTime deadline) {
  const SteadyTime end = std::max(deadline, parts_.clock.Steady() + kLastWrites);
  while (!parts_.journals.idle() && parts_.clock.Steady() < end) parts_.signal.Pause(kIdleLook);
}

void Drain::EndUnfinished() {
  parts_.logger.Warn("stopped_unsettled", {{"uplinks", parts_.ledgers.Sum().uplinks.in_flight}});
  std::_Exit(0);
}

}  // namespace uplink::lifecycle
