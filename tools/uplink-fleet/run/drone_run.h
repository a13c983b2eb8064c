#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "schema/base/clock.h"
#include "tools/uplink-fleet/compare/verify_drones.h"
#include "tools/uplink-fleet/drone/swarm.h"
#include "tools/uplink-fleet/report/live_display.h"
#include "tools/uplink-fleet/report/run_figures.h"
#include "tools/uplink-fleet/run/run_context.h"
#include "tools/uplink-fleet/run/run_options.h"
#include "tools/uplink-fleet/run/server_view.h"
#include "tools/uplink-fleet/run/signals.h"

namespace uplink::synthetic {

/// What AskAgain needs of a run with drones; all of it outlives it.
struct DroneContext {
  const Clock& clock;
  Signals& signals;
  DronesShared& shared;
};

/// One run with drones that call: they publish, settle and say each type once more; the server is
/// looked at; then what they know is compared and reported.
///
/// Thread: confined to main's thread; made before any other thread, since those inherit its mask of
/// signals.
class DroneRun final {
 public:
  explicit DroneRun(const RunOptions& options);

  /// Returns the program's exit code.
  [[nodiscard]] int Main();

 private:
  [[nodiscard]] absl::Status Begin();
  /// Until it is time to settle; an error if no call was ever answered.
  [[nodiscard]] absl::Status Send();
  /// True once that many groups have been counted; false at the deadline, or told to stop.
  [[nodiscard]] bool WaitFor(const std::atomic<std::size_t>& counted, std::size_t groups);
  void SettleAll(DroneSwarm& swarm);
  /// Looks at the server's counts; what was sent and answered is read so that they are between.
  [[nodiscard]] absl::Status Count();
  [[nodiscard]] absl::Status Gather(const DroneSwarm& swarm);
  [[nodiscard]] absl::Status CompareLive(const DroneScript& drone, SteadyTime until);
  [[nodiscard]] absl::Status CompareRows(const DroneScript& drone);
  [[nodiscard]] std::string Heading() const;
  void Look();
  [[nodiscard]] int Conclude(const DroneSwarm& swarm);

  RunOptions options_;
  SystemClock clock_;
  Signals signals_{clock_};
  DronesShared shared_;
  ServerView view_;
  const DroneContext context_;
  LiveDisplay display_;
  /// Since when it sends.
  SteadyTime began_{};
  /// The server's clock before the run, and at the last look.
  Span span_;
  std::int64_t started_at_ms_ = 0;
  DroneEvidence evidence_;
  DroneFigures figures_;
};

}  // namespace uplink::synthetic
