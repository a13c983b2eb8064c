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

/// How often to look for robots that were silent for too long.
inline constexpr std::chrono::seconds kForgetEvery{10};
/// From this share of robots_max on, we name robots that may leave for others.
inline constexpr std::size_t kRoomPercent = 90;
/// How many of them each second: as many new robots per second find room in a full fleet.
inline constexpr std::size_t kRoomMax = 256;

/// Lets robots leave memory that were silent for long, and names those that may leave for a new
/// robot when the fleet is full. The store keeps its rows of them, and they come back when they
/// speak.
///
/// The journal lets go of a robot before it leaves, since it may still have to write for it.
/// Thread: confined to one, except IsForgotten.
class Forgetting final {
 public:
  /// The references outlive it.
  struct Context {
    Fleet& fleet;
    const Clock& clock;
    const log::Logger& logger;
    /// fleet.forget_after; zero: robots leave only for others.
    milliseconds forget_after{0};
    /// Whether civil time is vouched for. While it is not, no robot counts as silent for long.
    std::function<bool()> clock_vouched;
    /// Asks the robot's journal to let go of it (Journal::Leave).
    std::function<void(robot::Robot& robot)> release;
  };
  explicit Forgetting(Context context) : context_(std::move(context)) {}

  /// Does what is due. Call it each second.
  void Round();
  /// Whether a robot that was last heard then must leave memory. Any thread.
  [[nodiscard]] bool IsForgotten(SystemTime heard_at) const;

 private:
  void RemoveLeft();
  void ForgetSilent();
  void NameRoom();

  const Context context_;
  limits::RecentTimes<1> looks_;
};

}  // namespace uplink::fleet
