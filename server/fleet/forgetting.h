#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <utility>

#include "schema/base/clock.h"
#include "server/fleet/fleet.h"
#include "server/limits/recent_times.h"
#include "server/log/logger.h"

namespace uplink::fleet {

/// How often robots are looked for that were not heard for too long.
inline constexpr std::chrono::seconds kForgetEvery{10};
/// From this share of robots_max on, robots are named that may leave for others.
inline constexpr std::size_t kRoomPercent = 90;
/// So many, for each second: as many new robots a second find room in a full fleet.
inline constexpr std::size_t kRoomMax = 256;

/// Lets robots leave memory that were not heard for long, and names those that may leave for a
/// robot that speaks when the fleet is full. The store keeps what it has of them, and they are
/// there again when they speak.
///
/// A robot that leaves is let go of by its journal first, which may have something of it to write.
///
/// Thread: confined to one, but for IsForgotten.
class Forgetting final {
 public:
  /// The references outlive it.
  struct Context {
    Fleet& fleet;
    const Clock& clock;
    const log::Logger& logger;
    /// fleet.forget_after; zero: robots leave only for others.
    milliseconds forget_after{0};
    /// Whether civil time can be believed: else nobody was silent for long.
    std::function<bool()> clock_vouched;
    /// Asks the robot's journal to let go of it (Journal::Leave).
    std::function<void(robot::Robot& robot)> release;
  };
  explicit Forgetting(Context context) : context_(std::move(context)) {}

  /// What is due; each second.
  void Round();
  /// Whether a robot that was heard last then is to be in memory no more. Any thread.
  [[nodiscard]] bool IsForgotten(SystemTime heard_at) const;

 private:
  void RemoveLeft();
  void ForgetSilent();
  void NameRoom();

  const Context context_;
  limits::RecentTimes<1> looks_;
};

}  // namespace uplink::fleet
