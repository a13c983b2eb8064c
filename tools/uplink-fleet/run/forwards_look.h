#pragma once

#include <cstddef>
#include <vector>

#include "tools/uplink-fleet/compare/compare_forwards.h"
#include "tools/uplink-fleet/robot/forward_board.h"
#include "tools/uplink-fleet/run/run_context.h"

namespace uplink::synthetic {

/// What the fleet shares as the server shows it, and what the receivers held at about that time. A
/// value.
struct ForwardsLook {
  SharedItems shared;
  std::vector<ReceiverTable> tables;
};

/// The robots that take what others share.
[[nodiscard]] std::size_t ReceiversOf(const Scenario& scenario);

/// Looks, in Stage::kLast, until both sides agree, for some seconds: items expire meanwhile, and
/// receivers are told of that a moment later. The last look if they never do.
[[nodiscard]] ForwardsLook LookAtForwards(const RunContext& run);

}  // namespace uplink::synthetic
