#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include <absl/status/statusor.h>

#include "schema/base/clock.h"
#include "server/fleet/fleet.h"
#include "server/fleet/heavy_writers.h"
#include "server/log/logger.h"
#include "server/loop/one_at_a_time.h"
#include "server/store/space_judge.h"
#include "storage/disk_space.h"

namespace uplink::store {

/// How often what each robot stored is measured.
inline constexpr std::chrono::seconds kWritersEvery{10};
/// Most robots that a line of the log names.
inline constexpr std::size_t kHeaviestNamedMax = 5;

/// Checks the store's disk repeatedly. Below store.free_min, robots that store far more than the
/// others are slowed down (HeavyWriters); below half of it, no robot stores anything. A robot that
/// is slowed down stays so until there is space again.
///
/// While the disk cannot be asked, the last judgement holds.
///
/// Thread: Round by one at a time, one that may wait; LookOn by one; view by any.
class SpaceRounds final {
 public:
  /// The references outlive it.
  struct Context {
    const fleet::Fleet& fleet;
    const Clock& clock;
    const log::Logger& logger;
    /// Measures the disk; empty if it cannot be known.
    std::function<absl::StatusOr<std::optional<storage::DiskSpace>>()> space;
    /// store.free_min.
    std::uint64_t free_min = 0;
  };
  explicit SpaceRounds(Context context);
  SpaceRounds(const SpaceRounds&) = delete;
  SpaceRounds& operator=(const SpaceRounds&) = delete;

  void Round();
  /// Posts a Round to a thread that may wait, unless one is under way.
  void LookOn(const loop::Post& post) {
    looks_.PostBy(post, [this] { Round(); });
  }
  /// As of the last round.
  [[nodiscard]] SpaceView view() const;

 private:
  using Writers = std::vector<fleet::HeavyWriters::Writer>;

  /// Asks, and judges.
  void Judge();
  /// Measures what robots stored since the last look, during which they may have been `stopped`.
  /// Returns those that are newly too heavy.
  Writers Sample(std::span<const fleet::RobotPtr> robots, bool stopped);
  /// Tells each robot what it may store.
  void Apply(std::span<const fleet::RobotPtr> robots) const;
  /// Logs a change, with the robots that stored most.
  void Tell(std::size_t limited_before) const;

  const Context context_;
  loop::OneAtATime looks_;
  fleet::HeavyWriters writers_;
  /// The result for view() when the round ends.
  SpaceView now_;
  SteadyTime sampled_;
  mutable std::mutex mutex_;
  SpaceView shown_;
};

}  // namespace uplink::store
