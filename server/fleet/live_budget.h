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

/// Past the budget, parts are dropped until 1 / kLiveRoomShare of it is free. The next look at all
/// robots comes once that is filled again.
inline constexpr std::size_t kLiveRoomShare = 16;
/// How long `degraded` shows that parts were dropped, and how often a line says so at most.
inline constexpr std::chrono::minutes kLiveDroppedShown{10};
inline constexpr std::chrono::minutes kLiveLineEvery{1};

/// The one budget of all live state in memory (limits.live_bytes_max), of robots and twins. Past
/// it, the certificate (for twins: the id) whose robots hold most loses their largest parts.
///
/// A robot counts for the certificate of its last stream: a gateway's, or its own. Robots that had
/// no stream since the server's start count together: one gateway may have brought them all, and a
/// robot that speaks must not lose before they do.
///
/// Messages only change the total (robot::LiveTotal). Once that is over the budget, the shares of
/// the holders are added up from all robots.
///
/// Limits: Context::bytes_max, exceeded by what threads add while one of them relieves it, and by
///         memory outside parts, which cannot be dropped.
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
  /// Construct it before the first thread. From now on a thread that applies a message past the
  /// budget calls Relieve.
  explicit LiveBudget(const Context& context);
  /// Destroy it after the last message was applied.
  ~LiveBudget() { context_.fleet.live_total()->SetTrigger(robot::LiveTotal::kNever); }
  LiveBudget(const LiveBudget&) = delete;
  LiveBudget& operator=(const LiveBudget&) = delete;

  /// Called each second by one thread: relieves the budget of what came without a message (a
  /// restore), and writes the line.
  void Round();
  /// Drops parts until 1 / kLiveRoomShare of the budget is free, or no part is left. Does nothing
  /// within the budget, or while another thread does it.
  void Relieve();

  [[nodiscard]] std::size_t bytes() const { return context_.fleet.live_total()->bytes(); }
  [[nodiscard]] std::size_t bytes_max() const { return context_.bytes_max; }
  [[nodiscard]] std::uint64_t parts_dropped() const { return parts_dropped_.load(); }
  /// Live state exceeds the budget, or parts were dropped within kLiveDroppedShown.
  [[nodiscard]] bool over() const;

 private:
  /// The holder that robots and twins count for, as key and value of the line: `gateway`, `robot`,
  /// `twin`, or `robots` for those without a stream.
  struct Name {
    std::string key;
    std::string text;
    friend auto operator<=>(const Name&, const Name&) = default;
  };
  /// One part of a robot, all live data of its calls, or one table of a twin.
  struct Part {
    std::size_t bytes = 0;
    /// One of the two is null.
    RobotPtr robot{};
    cyberwave::TwinPtr twin{};
    /// A storage::LivePart, or one past them for calls; or a cyberwave::TwinTable.
    std::size_t index = 0;
  };
  struct Holder {
    Name name;
    std::size_t bytes = 0;
    std::vector<RobotPtr> robots;
    std::vector<cyberwave::TwinPtr> twins;
    /// In ascending order of bytes. Empty until this is the largest holder.
    std::optional<std::vector<Part>> parts;
  };
  struct Loss {
    /// The most that the holder held before a loss, since the last line.
    std::size_t held_bytes = 0;
    /// Its losses since then.
    std::size_t parts = 0;
    std::size_t bytes = 0;
  };

  [[nodiscard]] static Name NameOf(const robot::Robot& robot);
  [[nodiscard]] std::vector<Holder> Holders() const;
  [[nodiscard]] static std::vector<Part> PartsOf(const Holder& holder);
  /// Drops the largest parts of the largest holder, at least one, until it holds no more than
  /// `next_bytes` or the goal is reached. False if it has none left.
  bool DropLargest(Holder& most, std::size_t next_bytes);
  /// Returns the bytes that it freed.
  [[nodiscard]] std::size_t Drop(const Part& part);
  /// Relieve drops parts until the total is at most this.
  [[nodiscard]] std::size_t goal() const {
    return context_.bytes_max - context_.bytes_max / kLiveRoomShare;
  }
  /// Writes the line about losses since the last one, if there are any and kLiveLineEvery has
  /// passed.
  void Tell();

  const Context context_;
  std::atomic<bool> relieving_{false};
  std::atomic<std::uint64_t> parts_dropped_{0};
  /// Zero: never.
  std::atomic<SteadyTime> dropped_at_{SteadyTime()};
  /// Used by Round alone.
  limits::RecentTimes<1> told_;
  mutable std::mutex mutex_;
  /// Since the last line, one entry per holder.
  std::map<Name, Loss> losses_;
};

}  // namespace uplink::fleet
