#pragma once

#include <cstdint>

#include "schema/base/clock.h"
#include "tools/uplink-fleet/compare/verify.h"
#include "tools/uplink-fleet/robot/histogram.h"
#include "tools/uplink-fleet/robot/shared.h"
#include "tools/uplink-fleet/run/gather.h"
#include "tools/uplink-fleet/run/measurement.h"
#include "tools/uplink-fleet/run/progress.h"
#include "tools/uplink-fleet/run/run_context.h"
#include "tools/uplink-fleet/run/run_options.h"
#include "tools/uplink-fleet/run/server_view.h"
#include "tools/uplink-fleet/run/signals.h"

namespace uplink::synthetic {

/// One run: the robots live, settle and leave; then what they know is compared and reported.
///
/// Thread: confined to main's thread; made before any other thread, since those inherit its mask of
/// signals.
class Run final {
 public:
  explicit Run(const RunOptions& options);

  /// Returns the program's exit code.
  [[nodiscard]] int Main();

 private:
  /// Lives through the stages; false if no robot was welcomed.
  [[nodiscard]] bool Live(Swarm& swarm);
  /// What the server shows before the run, unless the acks alone decide.
  [[nodiscard]] absl::Status LookBefore();
  [[nodiscard]] absl::Status GatherEvidence();
  [[nodiscard]] int Conclude();

  RunOptions options_;
  SystemClock clock_;
  Signals signals_{clock_};
  Shared shared_;
  ServerView view_;
  Progress progress_;
  const RunContext context_;
  RunOutcome outcome_;
  Evidence evidence_;
  Measured measured_;
  std::uint64_t sent_while_measured_ = 0;
  Latencies latencies_;
};

}  // namespace uplink::synthetic
