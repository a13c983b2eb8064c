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
#include "server/limits/recent_times.h"
#include "server/log/logger.h"

namespace uplink::fleet {

/// Past the budget 1 / kLiveRoomShare of it is made free: the next look at all robots comes once
/// that is filled again.
inline constexpr std::size_t kLiveRoomShare = 16;
/// How long `degraded` shows that parts were dropped, and how often at most a line says so.
inline constexpr std::chrono::minutes kLiveDroppedShown{10};
inline constexpr std::chrono::minutes kLiveLineEvery{1};

/// The one budget of all live state in memory (limits.live_bytes_max), of robots and twins. Past
/// it, the certificate (of twins: the id) whose robots hold most loses their largest parts.
///
/// A robot counts for the certificate of its last stream: a gateway's, or its own. Robots without a
/// stream in this life of the server count together: a gateway may have brought them all, and an
/// honest robot that speaks must not lose before they do.
///
/// The total alone is counted as messages come (robot::LiveTotal). Who holds how much of it is
/// added up from all robots once the total is over the budget.
///
/// Limits: Context::bytes_max, passed by what threads add while one of them relieves it, and by
///         what is no part: that cannot be dropped.
/// Thread: thread-safe. It holds no lock while it looks at robots.
class LiveBudget final {
 public:
  /// All of it outlives the budget.
  struct Context {
    const Clock& clock;
    Fleet& fleet;
    cyberwave::Twins& twins;
    const log::Logger& logger;
    /// At least 1 (run::LiveBytesMaxOf).
    std::size_t bytes_max = 0;
  };
  /// Before the first thread: from now on a thread that applies a message past the budget calls
  /// Relieve.
  explicit LiveBudget(const Context& context);
  /// After the last message was applied.
  ~LiveBudget() { context_.fleet.live_total()->SetTrigger(robot::LiveTotal::kNever); }
  LiveBudget(const LiveBudget&) = delete;
  LiveBudget& operator=(const LiveBudget&) = delete;

  /// Called each second by one thread: relieves what came otherwise than by a message (a restore),
  /// and writes the line.
  void Round();
  /// Drops parts until 1 / kLiveRoomShare of the budget is free, or no part is left. Does nothing
  /// within the budget, or while another thread does it.
  void Relieve();

  [[nodiscard]] std::size_t bytes() const { return context_.fleet.live_total()->bytes(); }
  [[nodiscard]] std::size_t bytes_max() const { return context_.bytes_max; }
  [[nodiscard]] std::uint64_t parts_dropped() const { return parts_dropped_.load(); }
  /// More is held than may be, or parts were dropped within kLiveDroppedShown.
  [[nodiscard]] bool over() const;

 private:
  /// For whom robots and twins count, as key and value of the line: `gateway`, `robot`, `twin`, or
  /// `robots` for those that were not heard.
  struct Name {
    std::string key;
    std::string text;
    friend auto operator<=>(const Name&, const Name&) = default;
  };
  /// One part of a robot, all that its calls say, or one table of a twin.
  struct Part {
    std::size_t bytes = 0;
    /// One of the two is null.
    RobotPtr robot{};
    cyberwave::TwinPtr twin{};
    /// A storage::LivePart, one past them of calls, or a cyberwave::TwinTable.
    std::size_t index = 0;
  };
  struct Holder {
    Name name;
    std::size_t bytes = 0;
    std::vector<RobotPtr> robots;
    std::vector<cyberwave::TwinPtr> twins;
    /// In ascending order of bytes. Read once this is the holder of most; nothing before.
    std::optional<std::vector<Part>> parts;
  };
  struct Loss {
    /// What the holder held before, the most of all times since the last line.
    std::size_t held_bytes = 0;
    /// What it lost.
    std::size_t parts = 0;
    std::size_t bytes = 0;
  };

  [[nodiscard]] static Name NameOf(const robot::Robot& robot);
  [[nodiscard]] std::vector<Holder> Holders() const;
  [[nodiscard]] static std::vector<Part> PartsOf(const Holder& holder);
  /// Drops the largest parts of the holder of most, at least one, until it holds no more than
  /// `next_bytes` or the goal is reached. False if it has none left.
  bool DropLargest(Holder& most, std::size_t next_bytes);
  /// Returns the bytes that it freed.
  [[nodiscard]] std::size_t Drop(const Part& part);
  /// Relieve drops parts until the total is at most this.
  [[nodiscard]] std::size_t goal() const {
    return context_.bytes_max - context_.bytes_max / kLiveRoomShare;
  }
  /// Writes the line about losses since the last one, if there are any and kLiveLineEvery is over.
  void Tell();

  const Context context_;
  std::atomic<bool> relieving_{false};
  std::atomic<std::uint64_t> parts_dropped_{0};
  /// Zero: never.
  std::atomic<SteadyTime> dropped_at_{SteadyTime()};
  /// The calls of Round alone.
  limits::RecentTimes<1> told_;
  mutable std::mutex mutex_;
  /// Since the last line, one entry per holder.
  std::map<Name, Loss> losses_;
};

}  // namespace uplink::fleet
