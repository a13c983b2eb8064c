#pragma once

#include <cstddef>
#include <string>

#include "schema/judge.h"
#include "server/robot/limits.h"
#include "server/robot/robot_state.h"
#include "storage/live_row.h"

namespace uplink::robot {

/// What changed as a row of a checkpoint. A part is the messages that make it, as its robot would
/// send them, each behind its length (32 bits, little endian): kLivePartBytesMax of them at most.
/// Pure.
[[nodiscard]] storage::LiveRow ToRow(std::string ruri, const LiveChanges& changes);

/// What a row says. Its messages are judged again: whatever the rules of this version do not pass
/// is left out, and counted.
struct LiveRead {
  LiveBefore before;
  std::size_t left_out = 0;
};
/// `judge` has JudgeLimitsOfLive(). No input makes it throw or abort.
[[nodiscard]] LiveRead FromRow(const storage::LiveRow& row, schema::Judge& judge);
[[nodiscard]] schema::JudgeLimits JudgeLimitsOfLive();

}  // namespace uplink::robot
