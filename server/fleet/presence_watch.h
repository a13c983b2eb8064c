#pragma once

#include <functional>

#include "metrics/cells.h"
#include "schema/base/clock.h"
#include "server/fleet/fleet.h"
#include "server/fleet/liveness.h"
#include "server/log/logger.h"

namespace uplink::fleet {

/// The two rounds on which presence rests: the sweep that judges each robot's silence, and the
/// handshake that shows whether the server itself hears robots. Confined to one thread.
class PresenceWatch final {
 public:
  /// All of it outlives the watch.
  struct Sources {
    const Clock& clock;
    Fleet& fleet;
    Liveness& liveness;
    const log::Logger& logger;
    metrics::LatencyDistribution& sweep_seconds;
    milliseconds session_idle;
    /// Whether other processes on the store may hear robots without our knowledge.
    std::function<bool()> others_unseen;
    /// Whether twins are heard through their broker; empty: no broker is read.
    std::function<Fleet::HearingState()> twins_hear{};
  };
  explicit PresenceWatch(const Sources& sources) : sources_(sources) {}

  /// Judges every robot, and logs when the relay falls behind and has caught up. A late sweep means
  /// that the process stood still: it logs for how long, and the relay counts as behind from then
  /// on.
  void Sweep();

  /// Begins a handshake with the relay's listener; calls `done`, once and on the same thread, with
  /// whether it was answered.
  using Ask = std::function<void(std::function<void(bool)> done)>;
  /// Asks unless the last handshake is still under way. The watch outlives the answer.
  void AskRelay(const Ask& ask);

 private:
  [[nodiscard]] Fleet::HearingState Hears() const;
  [[nodiscard]] Fleet::HearingState TwinsHear() const;
  void LogBehind();

  const Sources sources_;
  bool asking_ = false;
  /// The last handshake ended without an answer.
  bool refused_ = false;
  /// As of the last sweep.
  bool behind_ = false;
};

}  // namespace uplink::fleet
