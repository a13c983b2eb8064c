#include "server/run/drain.h"

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <utility>

#include "server/run/deadline.h"

namespace uplink::run {
namespace {

/// How often a drain looks whether the journal is empty.
constexpr milliseconds kIdleLook{10};

}  // namespace

Drain::Drain(Context context) : context_(std::move(context)) {}

void Drain::Run() {
  const milliseconds timeout = Timeout();
  const SteadyTime deadline = context_.clock.Steady() + timeout;
  context_.logger.Info(
      "draining", {{"streams", context_.transport.streams()}, {"timeout_ms", timeout.count()}});
  context_.monitor.BeginDrain();
  context_.stop_adopting();
  context_.drain_broker();
  context_.journals.RequestCheckpoint();
  const Deadline last(timeout + kStopWait, [this] { EndUnfinished(); });
  context_.transport.drain(timeout);
  // Ahead of the streams, which may take their time: another server reads on.
  context_.leave_broker();
  if (!context_.transport.wait_for_streams(timeout)) {
    context_.logger.Warn("streams_left", {{"streams", context_.transport.streams()}});
  }
  EndPresence();
  context_.journals.RequestCheckpoint();
  WaitForJournals(deadline);
  context_.stop();
  const std::int64_t unsettled = Unsettled();
  if (unsettled == 0) {
    context_.logger.Info("stopped");
  } else {
    context_.logger.Warn("stopped_unsettled", {{"uplinks", unsettled}});
  }
}

milliseconds Drain::Timeout() const {
  const bool shut_out = absl::IsUnimplemented(context_.journals.last_error());
  return shut_out ? std::min<milliseconds>(context_.timeout, kLastWrites) : context_.timeout;
}

void Drain::EndPresence() {
  // Another server that takes a robot over continues its presence.
  if (context_.leave()) return;
  for (const fleet::RobotPtr& robot : context_.fleet.Sorted()) {
    if (robot->state.held_since() == 0) continue;
    // One that is offline stays so: the next start goes on from there.
    if (robot->state.presence() != model::Presence::kOnline) continue;
    context_.journals.NotePresence(robot->id(), model::Presence::kUnknown, context_.clock.System(),
                                   {}, robot->state.parked_until());
  }
}

void Drain::WaitForJournals(SteadyTime deadline) {
  const SteadyTime end = std::max(deadline, context_.clock.Steady() + kLastWrites);
  while (!context_.journals.idle() && context_.clock.Steady() < end)
    context_.signal.Pause(kIdleLook);
}

std::int64_t Drain::Unsettled() const { return context_.ledgers.Sum().messages.in_flight; }

void Drain::EndUnfinished() {
  context_.logger.Warn("stopped_unsettled", {{"uplinks", Unsettled()}});
  context_.logger.Flush();
  std::_Exit(context_.signal.exit_code());
}

}  // namespace uplink::run
