#pragma once

#include "schema/base/clock.h"
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

}  // namespace uplink::synthetic
