#pragma once

#include <cstddef>
#include <string>

#include "schema/judge.h"
#include "server/robot/robot_state.h"
#include "storage/live_row.h"

namespace uplink::robot {

/// Bytes of one part in a checkpoint. Of a part that holds more, the keys that were updated last
/// are kept as far as they fit.
inline constexpr std::size_t kLivePartBytesMax = std::size_t{256} * 1024;

/// What changed as a row of a checkpoint. A part is the messages that make it, as its robot would
/// send them, each behind its length (32 bits, little endian). Pure.
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
