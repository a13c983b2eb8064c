#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "schema/base/clock.h"
#include "server/forward/item.h"
#include "server/limits/recent_times.h"
#include "server/limits/token_bucket.h"

namespace uplink::forward {

/// How much each robot makes all others receive, and the items whose changes wait because the robot
/// exceeds that. They are looked up again once they may go out, so an item that keeps changing is
/// forwarded in its latest form, less often.
///
/// Bound: robots that forwarded anything within the time in which a bucket fills; `waiting_max`
/// waiting items, past which changes pass unpaced.
/// Thread: confined to its owner's.
class Paces final {
 public:
  struct Limits {
    /// In bytes, to all receivers together.
    limits::BucketSize fan_out;
    std::size_t waiting_max = 0;
  };
  /// Which kind of change asks.
  enum class Turn : std::uint8_t {
    /// A change that was just read. It waits behind changes of its robot that already wait.
    kNew,
    /// A change that Due returned.
    kWaited,
  };
  explicit Paces(const Limits& limits) : limits_(limits) {}

  /// True: the item's change may go out now, and no longer waits. False: it waits.
  [[nodiscard]] bool Passes(const ItemKey& key, Turn turn, SteadyTime now);
  /// A change of the robot went to receivers, `bytes` in all.
  void NoteForwarded(const std::string& ruri, std::size_t bytes, SteadyTime now);
  /// The item is gone.
  void Forget(const ItemKey& key);
  /// Everything was read again: nothing waits.
  void ForgetAll();

  /// Items that may go out now, at most kDueMax. Of each robot as many as its rate probably allows;
  /// robots take turns, and so do the items of each. They wait until they pass.
  [[nodiscard]] std::vector<ItemKey> Due(SteadyTime now);
  /// When the next may go out; empty if none waits.
  [[nodiscard]] std::optional<SteadyTime> DueAt(SteadyTime now) const;
  [[nodiscard]] std::size_t waiting() const { return waiting_; }
  /// Robots whose changes wait, for OncePerRobotLog.
  [[nodiscard]] std::map<std::string, std::string> robots() const;

 private:
  struct Robot {
    limits::TokenBucket bucket;
    /// The bytes of its last change: the next one probably takes as many.
    std::size_t last_bytes = 1;
    std::set<ItemKey> waiting;
    /// The last item that had its turn.
    std::optional<ItemKey> last;
  };
  [[nodiscard]] bool PassesNow(const Robot& robot, std::size_t changes, SteadyTime now) const;
  void AddDue(Robot& robot, SteadyTime now, std::vector<ItemKey>& into) const;
  void DropIdle(SteadyTime now);

  const Limits limits_;
  std::map<std::string, Robot> robots_;
  std::size_t waiting_ = 0;
  /// The last robot that had its turn.
  std::string last_robot_;
  limits::RecentTimes<1> idle_looks_;
};

}  // namespace uplink::forward
