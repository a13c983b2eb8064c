#pragma once

#include <algorithm>
#include <optional>

#include "schema/base/clock.h"
#include "tools/uplink-fleet/robot/shared.h"

namespace uplink::synthetic {

/// Between two looks of a robot that has not come yet.
inline constexpr milliseconds kArrivalLook{100};

/// When a robot comes: at its time, or with the end of Stage::kRun, which may come sooner.
///
/// Thread: confined to the loop's thread.
class Arrival final {
 public:
  explicit Arrival(SteadyTime at) : at_(at) {}

  /// When to look again; nothing once the robot is there.
  [[nodiscard]] std::optional<SteadyTime> Awaited(SteadyTime now, Stage stage) {
    here_ = here_ || now >= at_ || stage != Stage::kRun;
    if (here_) return std::nullopt;
    return std::min(at_, now + kArrivalLook);
  }

 private:
  SteadyTime at_;
  bool here_ = false;
};

}  // namespace uplink::synthetic
