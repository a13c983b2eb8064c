#include "server/session/resend_requests.h"

#include <cstddef>

#include "server/session/frames.h"
#include "server/session/limits.h"

namespace uplink::session {

void ResendRequests::Begin() { first_at_ = sources_.context.clock.Steady() + kResendGrace; }

void ResendRequests::Follow() {
  const robot::ResendView view = sources_.robot.robot().sessions.resend_view();
  CountUnanswered(view.unanswered);
  StreamTimers& timers = sources_.timers;
  if (view.missing == 0) return timers.Clear(Timer::kResend);
  if (!timers.is_set(Timer::kResend)) timers.Set(Timer::kResend, first_at_);
  const SteadyTime now = sources_.context.clock.Steady();
  if (!timers.Due(Timer::kResend, now)) return;
  // Queued behind frames that the agent has yet to read, never in their place.
  if (sources_.outgoing.size() > 0) return timers.Set(Timer::kResend, now + kResendGrace);
  const robot::Resends::Due due = sources_.robot.robot().sessions.TakeResends(now);
  timers.Set(Timer::kResend, due.next.value_or(now + robot::kResendEvery));
  if (due.kinds == 0) return;
  sources_.outgoing.Push(ResendRequestFrame(due.kinds));
  for (const storage::LatestKind kind : storage::kEachLatestKind) {
    if ((due.kinds & BitOf(kind)) == 0) continue;
    sources_.context.probe.resend_requests_total[static_cast<std::size_t>(kind)].Add();
  }
  CountUnanswered(view.unanswered | due.kinds);
}

void ResendRequests::CountUnanswered(storage::LatestKindSet unanswered) {
  if (unanswered == unanswered_) return;
  for (const storage::LatestKind kind : storage::kEachLatestKind) {
    const storage::LatestKindSet bit = BitOf(kind);
    if (((unanswered ^ unanswered_) & bit) == 0) continue;
    sources_.context.probe.resend_unanswered[static_cast<std::size_t>(kind)].Add(
        (unanswered & bit) != 0 ? 1 : -1);
  }
  unanswered_ = unanswered;
}

}  // namespace uplink::session
