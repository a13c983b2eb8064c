#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "schema/base/clock.h"
#include "schema/judge.h"
#include "schema/model/rcan.h"
#include "schema/model/record.h"
#include "server/robot/robot_state.h"

namespace uplink::session {

/// The live messages of the current frame, in order, until they are applied to the robot's state
/// together. Reused for the next frame, so that it does not allocate. Confined to its thread.
///
/// Bound: the messages of one frame (limits.batch_uplinks_max).
class FrameLive final {
 public:
  /// Returns the older message of the frame that this one replaces completely, if any.
  [[nodiscard]] std::optional<model::Record> Add(model::Record record);
  /// Whether it replaces an older Robot State of the frame.
  enum class Before : std::uint8_t { kNone, kReplaced };
  [[nodiscard]] Before Add(model::RcanState state);
  /// Applies them all and is empty afterwards; the records' memory goes back to `judge`. Returns
  /// how many there were.
  std::size_t Apply(robot::RobotState& state, SteadyTime arrived, schema::Judge& judge);

 private:
  std::vector<model::Record> records_;
  std::optional<model::RcanState> rcan_;
};

}  // namespace uplink::session
