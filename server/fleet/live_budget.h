#pragma once

#include <atomic>
#include <chrono>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "schema/base/clock.h"
#include "server/cyberwave/twins.h"
#include "server/fleet/fleet.h"
#include "server/log/logger.h"

namespace uplink::fleet {

/// Past the budget this share of it is made free, so that the next look is that far away.
inline constexpr std::size_t kLiveRoomShare = 16;
/// How long `degraded` shows that parts were dropped, and how far lines about it are apart.
inline constexpr std::chrono::minutes kLiveDroppedShown{10};
inline constexpr std::chrono::minutes kLiveLineEvery{1};

/// The one budget of all live state in memory (limits.live_bytes_max), of robots and twins. Past
/// it, the certificate (of twins: the id) whose robots hold most loses their largest parts.
///
/// A robot counts for the certificate of its last stream: a gateway's, or its own. Those without a
/// stream in this life of the server count together: a gateway may have brought them all, and an
/// honest robot that speaks is not to lose before them.
/// Thread: thread-safe. It holds no lock while it looks at robots.
class LiveBudget final {
 public:
  /// All of it outlives the budget.
  struct Context {
    const Clock& clock;
    Fleet& fleet;
    cyberwave::Twins& twins;
    const log::Logger& logger;
    std::size_t bytes_max = 0;
  };
  /// Before the first thread: from now on whoever applies a message past the budget relieves it.
  explicit LiveBudget(const Context& context);
  /// Nobody applies messages any more.
  ~LiveBudget() { context_.fleet.live_total()->SetTrigger(robot::LiveTotal::kNever); }
  LiveBudget(const LiveBudget&) = delete;
  LiveBudget& operator=(const LiveBudget&) = delete;

  /// Each second: relieves what came otherwise than by a message, and writes the line.
  void Round();
  /// Drops parts until the total is kLiveRoomShare below the budget. At once if the budget is not
  /// reached, or if another thread does it already.
  void Relieve();

  [[nodiscard]] std::size_t bytes() const { return context_.fleet.live_total()->bytes(); }
  [[nodiscard]] std::size_t bytes_max() const { return context_.bytes_max; }
  [[nodiscard]] std::uint64_t parts_dropped() const { return parts_dropped_.load(); }
  /// More is held than may be, or parts were dropped within kLiveDroppedShown.
  [[nodiscard]] bool over() const;

 private:
  /// For whom robots and twins count, with the word of a line's key.
  struct Name {
    std::string kind;
    std::string text;
    friend auto operator<=>(const Name&, const Name&) = default;
  };
  /// One part of a robot, or one table of a twin; one of the two is null.
  struct Part {
    std::size_t bytes = 0;
    RobotPtr robot;
    cyberwave::TwinPtr twin;
    std::size_t index = 0;
  };
  struct Holder {
    Name name;
    std::size_t bytes = 0;
    std::vector<RobotPtr> robots;
    std::vector<cyberwave::TwinPtr> twins;
    /// Made when it is the first time the one that holds most; the largest last.
    std::optional<std::vector<Part>> parts;
  };
  struct Loss {
    std::size_t held_bytes = 0;
    std::size_t parts = 0;
    std::size_t bytes = 0;
  };

  [[nodiscard]] static Name NameOf(const robot::Robot& robot);
  [[nodiscard]] std::vector<Holder> Holders() const;
  [[nodiscard]] static std::vector<Part> PartsOf(const Holder& holder);
  /// Drops parts of the one that holds most until it holds less than `next_bytes`, at least one.
  /// False if it has none left.
  bool DropLargest(Holder& most, std::size_t next_bytes);
  [[nodiscard]] std::size_t Drop(const Part& part);
  [[nodiscard]] std::size_t goal() const {
    return context_.bytes_max - context_.bytes_max / kLiveRoomShare;
  }
  void Tell();

  const Context context_;
  std::atomic<bool> relieving_{false};
  std::atomic<std::uint64_t> parts_dropped_{0};
  /// Zero: never.
  std::atomic<SteadyTime> dropped_at_{SteadyTime()};
  /// The calls of Round alone.
  SteadyTime told_at_;
  mutable std::mutex mutex_;
  /// What was not told yet, one entry per Holder.
  std::map<Name, Loss> losses_;
};

}  // namespace uplink::fleet
