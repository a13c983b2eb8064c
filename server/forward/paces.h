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

/// How much each robot makes all others receive, and the items whose changes wait because it is
/// over that. They are looked up again once they may go out, so that of an item that goes on
/// changing the latest is told, less often.
///
/// Bound:  robots that forwarded anything within the time in which a bucket fills; at most
///         `waiting_max` items wait, and past that nothing more does.
/// Thread: confined to its owner's.
class Paces final {
 public:
  struct Limits {
    /// In bytes, to all receivers together.
    limits::BucketSize fan_out;
    std::size_t waiting_max = 0;
  };
  /// Whose turn it is.
  enum class Turn : std::uint8_t {
    /// A change that was read just now. It waits behind those of its robot that wait already.
    kNew,
    /// One that Due gave.
    kWaited,
  };
  explicit Paces(const Limits& limits) : limits_(limits) {}

  /// The item's change may go out now, and waits no more. False: it waits.
  [[nodiscard]] bool Passes(const ItemKey& key, Turn turn, SteadyTime now);
  /// A change of the robot's went to receivers, with so many bytes in all.
  void NoteForwarded(const std::string& ruri, std::size_t bytes, SteadyTime now);
  /// The item is there no more.
  void Forget(const ItemKey& key);
  /// Everything was told anew: nothing waits.
  void ForgetAll();

  /// Items that may go out by now, at most kDueMax. Of each robot as many as its rate probably lets
  /// out; robots, and the items of each, in turn. They wait until they pass.
  [[nodiscard]] std::vector<ItemKey> Due(SteadyTime now);
  /// When some may go out; nothing if none waits.
  [[nodiscard]] std::optional<SteadyTime> DueAt(SteadyTime now) const;
  [[nodiscard]] std::size_t waiting() const { return waiting_; }
  /// Whose changes wait, for ToldRobots.
  [[nodiscard]] std::map<std::string, std::string> robots() const;

 private:
  struct Robot {
    limits::TokenBucket bucket;
    /// What its last change took: the next one probably takes as much.
    std::size_t last_bytes = 1;
    std::set<ItemKey> waiting;
    /// The last of them that had its turn.
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
