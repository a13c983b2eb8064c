#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include <absl/status/statusor.h>

#include "schema/base/clock.h"
#include "server/fleet/robot_state.h"
#include "server/session/robot_sessions.h"
#include "storage/types.h"

namespace uplink::fleet {

/// Told of each change of a robot's presence, a robot's in order. Called on any thread, under a
/// lock of the robot: short, and never back into the fleet.
using PresenceChanged =
    std::function<void(const storage::RobotRef& robot, Presence presence, SystemTime at)>;

/// One robot that this process knows. Never destroyed before the process ends, so plain pointers to
/// it are safe on every thread. Its parts are thread-safe.
class Robot final {
 public:
  /// `changed` outlives the robot.
  Robot(storage::RobotRef id, SteadyTime server_started, const Clock& clock,
        const PresenceChanged& changed);

  /// Identity now. The fleet part may change when the robot gets a certificate of another fleet.
  [[nodiscard]] storage::RobotRef id() const;
  void SetFleet(std::string_view fleet);
  [[nodiscard]] const std::string& ruri() const { return ruri_; }

  RobotState state;
  session::RobotSessions sessions;

 private:
  const std::string ruri_;
  mutable std::mutex mutex_;
  storage::RobotRef id_;
};

/// How many robots are of each presence.
struct PresenceCounts {
  std::int64_t unknown = 0;
  std::int64_t online = 0;
  std::int64_t offline = 0;
};

/// All robots by RURI, at most `robots_max`. Thread-safe.
class Fleet final {
 public:
  Fleet(const Clock& clock, std::size_t robots_max, const PresenceLimits& presence);

  /// Before the first robot and the first thread.
  void OnPresence(PresenceChanged changed) { changed_ = std::move(changed); }

  /// The robot, admitted if it is new; kResourceExhausted at robots_max.
  [[nodiscard]] absl::StatusOr<Robot*> FindOrAdmit(const model::RobotId& id);
  /// The robot, admitted, or null if it is known already: then nothing of it changes. Errors: as
  /// FindOrAdmit.
  [[nodiscard]] absl::StatusOr<Robot*> AdmitNew(const model::RobotId& id);
  /// Null if it was never seen.
  [[nodiscard]] Robot* Find(std::string_view ruri) const;
  /// All robots, in the order in which they were admitted.
  [[nodiscard]] std::vector<Robot*> All() const;
  /// All robots by RURI.
  [[nodiscard]] std::vector<Robot*> Sorted() const;
  [[nodiscard]] std::size_t size() const { return size_.load(); }
  [[nodiscard]] std::size_t robots_max() const { return robots_max_; }
  [[nodiscard]] bool full() const { return size() >= robots_max_; }

  [[nodiscard]] const PresenceLimits& presence_limits() const { return presence_; }
  [[nodiscard]] SteadyTime server_started() const { return started_; }

  /// A sweep is due each second; one that comes later than this after the last shows that the
  /// server stood still.
  static constexpr std::chrono::seconds kSweepLate{3};

  /// Whether what robots sent has been read. While the server is behind nobody becomes offline:
  /// whose silence is too long is unknown, and so for presence.timeout after.
  enum class Hearing : std::uint8_t { kUpToDate, kBehind };

  /// The periodic check: brings every robot's presence up to date, forgets sessions that have been
  /// idle for `session_idle`, and counts.
  PresenceCounts Sweep(milliseconds session_idle, Hearing hearing = Hearing::kUpToDate);
  /// The counts of the last sweep.
  [[nodiscard]] PresenceCounts presence_counts() const;

 private:
  static constexpr std::size_t kShards = 64;
  struct Shard {
    mutable std::mutex mutex;
    std::unordered_map<std::string, std::unique_ptr<Robot>> robots;
  };
  /// With the shard's lock held.
  [[nodiscard]] absl::StatusOr<Robot*> Admit(Shard& shard, const model::RobotId& id);
  [[nodiscard]] Shard& ShardOf(std::string_view ruri);
  [[nodiscard]] const Shard& ShardOf(std::string_view ruri) const;

  const Clock& clock_;
  const std::size_t robots_max_;
  const PresenceLimits presence_;
  const SteadyTime started_;
  PresenceChanged changed_;
  /// Zero before the first.
  std::atomic<SteadyTime> last_sweep_{SteadyTime()};
  std::array<Shard, kShards> shards_;
  std::atomic<std::size_t> size_{0};
  mutable std::mutex admitted_mutex_;
  /// In order. Robots are never forgotten, so it only grows.
  std::vector<Robot*> admitted_;
  mutable std::mutex counts_mutex_;
  PresenceCounts counts_;
};

}  // namespace uplink::fleet
