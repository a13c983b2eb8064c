#include "server/session/settling.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "server/session/end_status.h"

namespace uplink::session {

void Settling::BeginHalfClosed() {
  Begin(absl::OkStatus(), ReadGate::Reading::kFlowing);
  SetTime();
}

void Settling::BeginDrained(transport::EndCause cause) {
  Begin(Drained(), ReadGate::Reading::kHeldBack);
  cause_ = cause;
}

void Settling::BeginUnconfirmed() {
  Begin(absl::UnavailableError(fmt::format(
            "{} Rejects of this session are above Hello.settled_seq, the limit is {}: process "
            "them, and reconnect with the through_seq of the last Ack",
            sources_.robot.robot().sessions.unconfirmed(),
            sources_.context.limits.unconfirmed_rejects_max)),
        ReadGate::Reading::kHeldBack);
  sources_.context.probe.unconfirmed_total.Add();
  cause_ = transport::EndCause::kUnconfirmed;
  unconfirmed_ = true;
  follows_writes_ = true;
  SetTime();
}

void Settling::Begin(absl::Status status, ReadGate::Reading reading) {
  status_ = std::move(status);
  sources_.outgoing.EndForwards();
  sources_.timers.Clear(Timer::kResend);
  // Held back if the server stopped listening, so that the robot does not become offline.
  sources_.reading.SetReading(reading);
}

void Settling::SetTime() {
  sources_.timers.Set(Timer::kSettle,
                      sources_.context.clock.Steady() + sources_.context.limits.drain_timeout);
}

void Settling::EndWithin(milliseconds grace) {
  const SteadyTime until = sources_.context.clock.Steady() + grace;
  sources_.timers.Set(Timer::kSettle,
                      std::min(until, sources_.timers.at(Timer::kSettle).value_or(until)));
  follows_writes_ = false;
}

void Settling::OnWritten() {
  if (follows_writes_ && sources_.outgoing.size() > 0) SetTime();
}

std::optional<absl::Status> Settling::StatusWhenSettled() {
  if (sources_.robot.waiting() > 0 || sources_.robot.AwaitsRejects()) return std::nullopt;
  // Another process took the robot, and waiting messages are void: the wake that is on its way ends
  // this.
  if (sources_.robot.standing() != robot::Standing::kCurrent) return std::nullopt;
  if (!last_ack_queued_) {
    last_ack_queued_ = true;
    sources_.outgoing.MakeAckDue();
    sources_.outgoing.Flush();
  }
  if (!sources_.outgoing.idle()) return std::nullopt;
  return status_;
}

}  // namespace uplink::session
