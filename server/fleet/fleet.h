#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include <absl/status/statusor.h>

#include "schema/base/clock.h"
#include "server/robot/robot.h"
#include "storage/types.h"

namespace uplink::fleet {

/// How many robots are of each presence.
struct PresenceTally {
  std::int64_t unknown = 0;
  std::int64_t online = 0;
  std::int64_t offline = 0;

  void Count(robot::Presence presence);
};

/// The same of those that this process judges.
struct PresenceCounts : PresenceTally {
  /// Of those that another process holds, as that one wrote it.
  PresenceTally elsewhere;
};

/// All robots by RURI, at most `robots_max`. Thread-safe.
class Fleet final {
 public:
  Fleet(const Clock& clock, std::size_t robots_max, const robot::PresenceLimits& presence);

  /// Before the first robot and the first thread.
  void OnPresence(robot::PresenceChanged changed) { changed_ = std::move(changed); }

  /// The robot, admitted if it is new; kResourceExhausted at robots_max.
  [[nodiscard]] absl::StatusOr<robot::Robot*> FindOrAdmit(const model::RobotId& id);
  /// The robot, admitted, or null if it is known already: then nothing of it changes. Errors: as
  /// FindOrAdmit.
  [[nodiscard]] absl::StatusOr<robot::Robot*> AdmitNew(const model::RobotId& id);
  /// Null if it was never seen.
  [[nodiscard]] robot::Robot* Find(std::string_view ruri) const;
  /// All robots, in the order in which they were admitted.
  [[nodiscard]] std::vector<robot::Robot*> All() const;
  /// All robots by RURI.
  [[nodiscard]] std::vector<robot::Robot*> Sorted() const;
  [[nodiscard]] std::size_t size() const { return size_.load(); }
  [[nodiscard]] std::size_t robots_max() const { return robots_max_; }
  [[nodiscard]] bool full() const { return size() >= robots_max_; }

  [[nodiscard]] const robot::PresenceLimits& presence_limits() const { return presence_; }
  [[nodiscard]] SteadyTime server_started() const { return started_; }

  /// A sweep is due each second; one that comes later than this after the last shows that the
  /// server stood still. It judges nobody.
  static constexpr std::chrono::seconds kSweepLate{3};

  /// Whether what robots send comes to this process's knowledge. Of whom it would not, nobody
  /// becomes offline: whose silence is too long is unknown, and so for presence.timeout after.
  enum class Hearing : std::uint8_t {
    kUpToDate,
    /// Robots that left may stream to another process, which cannot reach the store and tell.
    kHereAlone,
    /// What robots sent has not been read.
    kBehind,
  };

  /// The periodic check: brings the presence of every robot that this process judges up to date,
  /// forgets sessions that have been idle for `session_idle`, and counts.
  PresenceCounts Sweep(milliseconds session_idle, Hearing hearing = Hearing::kUpToDate);
  /// Whether the last sweep came late.
  [[nodiscard]] bool stood_still() const { return stood_still_.load(); }
  /// The counts of the last sweep that judged.
  [[nodiscard]] PresenceCounts presence_counts() const;

 private:
  static constexpr std::size_t kShards = 64;
  struct Shard {
    mutable std::mutex mutex;
    std::unordered_map<std::string, std::unique_ptr<robot::Robot>> robots;
  };
  /// With the shard's lock held.
  [[nodiscard]] absl::StatusOr<robot::Robot*> Admit(Shard& shard, const model::RobotId& id);
  [[nodiscard]] Shard& ShardOf(std::string_view ruri);
  [[nodiscard]] const Shard& ShardOf(std::string_view ruri) const;

  const Clock& clock_;
  const std::size_t robots_max_;
  const robot::PresenceLimits presence_;
  const SteadyTime started_;
  robot::PresenceChanged changed_;
  /// Zero before the first.
  std::atomic<SteadyTime> last_sweep_{SteadyTime()};
  std::atomic<bool> stood_still_{false};
  std::array<Shard, kShards> shards_;
  std::atomic<std::size_t> size_{0};
  mutable std::mutex admitted_mutex_;
  /// In order. Robots are never forgotten, so it only grows.
  std::vector<robot::Robot*> admitted_;
  mutable std::mutex counts_mutex_;
  PresenceCounts counts_;
};

}  // namespace uplink::fleet
