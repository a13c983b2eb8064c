#pragma once

#include <cstddef>
#include <string>

#include "schema/judge.h"
#include "server/robot/limits.h"
#include "server/robot/robot_state.h"
#include "storage/live_row.h"

namespace uplink::robot {

/// Changed parts as a row of a checkpoint. A part consists of messages as its robot would send
/// them, each after its length (32 bits, little endian), at most kLivePartBytesMax. Pure.
[[nodiscard]] storage::LiveRow ToRow(std::string ruri, const LiveChanges& changes);

/// The content of a row. Its messages are judged again; those that this version's rules do not
/// accept are left out and counted.
struct LiveRead {
  LiveBefore before;
  std::size_t left_out = 0;
};
/// `judge` has JudgeLimitsOfLive(). No input makes it throw or abort.
[[nodiscard]] LiveRead FromRow(const storage::LiveRow& row, schema::Judge& judge);
[[nodiscard]] schema::JudgeLimits JudgeLimitsOfLive();

}  // namespace uplink::robot
