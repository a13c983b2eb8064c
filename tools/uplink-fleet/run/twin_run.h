#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "schema/base/clock.h"
#include "tools/uplink-fleet/broker/twin_swarm.h"
#include "tools/uplink-fleet/compare/compare_twin_rows.h"
#include "tools/uplink-fleet/compare/verify_twins.h"
#include "tools/uplink-fleet/report/live_display.h"
#include "tools/uplink-fleet/report/run_figures.h"
#include "tools/uplink-fleet/run/run_context.h"
#include "tools/uplink-fleet/run/run_options.h"
#include "tools/uplink-fleet/run/server_view.h"
#include "tools/uplink-fleet/run/signals.h"

namespace uplink::synthetic {

/// What AskAgain needs of a run with twins; all of it outlives it.
struct TwinContext {
  const Clock& clock;
  Signals& signals;
  TwinsShared& shared;
};

/// One run with twins behind a broker: they publish, settle and are quiet; the server is looked at;
/// then what they know is compared and reported.
///
/// Thread: confined to main's thread; made before any other thread, since those inherit its mask of
/// signals.
class TwinRun final {
 public:
  /// `options.twins` must be there.
  explicit TwinRun(const RunOptions& options);

  /// Returns the program's exit code.
  [[nodiscard]] int Main();

 private:
  [[nodiscard]] absl::Status Begin();
  /// Until it is time to settle; an error if no connection ever came to be.
  [[nodiscard]] absl::Status Send(const TwinSwarm& swarm);
  /// True once that many groups have been counted; false at the deadline, or told to stop.
  [[nodiscard]] bool WaitFor(const std::atomic<std::size_t>& counted, std::size_t groups);
  /// Waits until the server has settled all that it received.
  void AwaitServer();
  [[nodiscard]] absl::Status Gather(const TwinSwarm& swarm);
  [[nodiscard]] absl::Status CompareTwin(const TwinScript& twin, const TwinLook& look,
                                         std::vector<v1::Quarantined>& no_robot);
  [[nodiscard]] absl::StatusOr<TwinLook> LookAt(const TwinScript& twin);
  [[nodiscard]] absl::StatusOr<StoredTwin> StoredOf(const TwinScript& twin);
  [[nodiscard]] std::string Heading() const;
  void Look();
  [[nodiscard]] int Conclude(const TwinSwarm& swarm);

  const RunOptions options_;
  SystemClock clock_;
  Signals signals_{clock_};
  TwinsShared shared_;
  ServerView view_;
  const TwinContext context_;
  LiveDisplay display_;
  /// Looks at every robot while the link was quiet, in the order of the swarm.
  std::vector<TwinLook> looks_;
  /// Since when it sends.
  SteadyTime began_{};
  /// The server's clock before the run, and at the last look.
  Span span_;
  std::int64_t started_at_ms_ = 0;
  TwinEvidence evidence_;
  TwinFigures figures_;
};

}  // namespace uplink::synthetic
