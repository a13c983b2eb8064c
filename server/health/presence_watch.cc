#include "server/health/presence_watch.h"

namespace uplink::health {

static_assert(
    kHandshakeEvery + kBehindAfter < robot::PresenceLimits{}.timeout,
    "a robot that reports often is not offline before the server knows that it is behind");

void PresenceWatch::Sweep() {
  using enum fleet::Fleet::Hearing;
  const SteadyTime began = sources_.clock.Steady();
  const bool behind = sources_.liveness.behind();
  if (behind && !behind_) {
    sources_.logger.Warn("relay_behind", {{"why", refused_ ? "refused" : "late"}});
  }
  if (!behind && behind_) sources_.logger.Info("relay_caught_up", {});
  behind_ = behind;
  sources_.fleet.Sweep(sources_.session_idle, behind ? kBehind : kUpToDate);
  sources_.sweep_seconds.ObserveSince(began, sources_.clock.Steady());
}

void PresenceWatch::AskRelay(const Ask& ask) {
  if (asking_) return;
  asking_ = true;
  sources_.liveness.NoteAsked();
  ask([this](bool answered) {
    asking_ = false;
    refused_ = !answered;
    if (answered) sources_.liveness.NoteHandshake();
  });
}

}  // namespace uplink::health
