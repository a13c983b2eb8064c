#pragma once

#include <string>
#include <vector>

#include <absl/status/status.h>

#include "schema/base/clock.h"
#include "tools/uplink-fleet/compare/verify.h"
#include "tools/uplink-fleet/robot/shared.h"
#include "tools/uplink-fleet/run/progress.h"
#include "tools/uplink-fleet/run/run_options.h"
#include "tools/uplink-fleet/run/server_view.h"
#include "tools/uplink-fleet/run/signals.h"

namespace uplink::synthetic {

/// What the steps of one run work with; all of it outlives them.
struct RunContext {
  const RunOptions& options;
  const Clock& clock;
  Signals& signals;
  Shared& shared;
  ServerView& view;
  Progress& progress;
};

/// Between two looks at what the robots have done.
inline constexpr milliseconds kLook{100};

/// For a server that does not answer while it is looked at: a start takes a second or two.
inline constexpr milliseconds kAnswerDeadline{10'000};

/// Asks again for some seconds while the server does not answer: it may be starting. Gives the last
/// answer at the deadline, or when a signal comes. `run` is a RunContext or a TwinContext.
template <typename Context, typename Ask>
[[nodiscard]] auto AskAgain(const Context& run, const Ask& ask) -> decltype(ask()) {
  const SteadyTime start = run.clock.Steady();
  while (true) {
    auto answer = ask();
    if (answer.ok() || run.clock.Steady() - start > kAnswerDeadline) return answer;
    run.shared.first_error.Keep(std::string(answer.status().message()));
    if (run.signals.Wait(kLook)) return answer;
  }
}

/// Another text for each run.
[[nodiscard]] std::string RandomRun();

/// Says why there is no report; gives the exit code.
[[nodiscard]] int CannotRun(const absl::Status& status);

/// Shows the report; gives the exit code for these lines of the table.
[[nodiscard]] int Concluded(const std::string& report, const std::vector<CheckRow>& rows);

}  // namespace uplink::synthetic
