#include "server/fleet/presence_watch.h"

#include <chrono>

namespace uplink::fleet {

static_assert(
    kHandshakeEvery + kBehindAfter < robot::PresenceLimits{}.timeout,
    "a robot that reports often is not offline before the server knows that it is behind");

Fleet::HearingState PresenceWatch::Hears() const {
  using enum Fleet::HearingState;
  if (sources_.liveness.behind()) return kBehind;
  return sources_.others_unseen() ? kHereAlone : kUpToDate;
}

Fleet::HearingState PresenceWatch::TwinsHear() const {
  return sources_.twins_hear ? sources_.twins_hear() : Fleet::HearingState::kBehind;
}

void PresenceWatch::Sweep() {
  const SteadyTime began = sources_.clock.Steady();
  sources_.fleet.Sweep(sources_.session_idle, Hears(), TwinsHear());
  // The fleet decides this by its own reading of the clock: the process may be stopped between any
  // two readings.
  if (sources_.fleet.stood_still()) {
    sources_.liveness.NoteStandstill();
    const auto time = std::chrono::duration_cast<milliseconds>(sources_.fleet.stood_still_for());
    sources_.logger.Warn("standstill_over", {{"ms", time.count()}});
  }
  LogBehind();
  sources_.sweep_seconds.ObserveSince(began, sources_.clock.Steady());
}

void PresenceWatch::LogBehind() {
  const bool behind = sources_.liveness.behind();
  if (behind && !behind_) {
    const char* why = refused_ ? "refused" : "late";
    if (sources_.fleet.stood_still()) why = "stood_still";
    sources_.logger.Warn("relay_behind", {{"why", why}});
  }
  if (!behind && behind_) sources_.logger.Info("relay_caught_up", {});
  behind_ = behind;
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

}  // namespace uplink::fleet
