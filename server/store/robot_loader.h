#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "schema/base/clock.h"
#include "server/fleet/fleet.h"
#include "server/journal/shards.h"
#include "storage/reader.h"

namespace uplink::store {

/// If limits.robots_max leaves no room for all robots, we still read the names of so many fleets:
/// those with a name beyond ASCII, since such a name may be odd (fleet::OddFleets).
inline constexpr std::uint32_t kFleetsReadMax = 10'000;

/// Loads the robots that the store knows into the fleet, as their last holders wrote them, with
/// their last sessions: at the start, or once the store can be reached. A robot that connected
/// meanwhile stays as it is.
///
/// Thread: Run by one thread at a time.
class RobotLoader final {
 public:
  /// The references outlive it.
  struct Context {
    fleet::Fleet& fleet;
    const journal::Shards& journals;
    storage::Reader& reader;
    /// Set if no other process can have the store. Then every earlier holder has ended, so its
    /// robots are adopted, and may be silent for so long before they are offline.
    std::optional<milliseconds> adopt_grace;
    /// Whether a robot that was last heard then must not be in memory.
    std::function<bool(SystemTime heard_at)> is_forgotten = [](SystemTime) { return false; };
  };
  explicit RobotLoader(const Context& context) : context_(context) {}

  /// Reads the robots, most recently heard first, up to the room. Returns how many were left out:
  /// they come into memory when they speak. Errors: of the reader; it may then be run again.
  [[nodiscard]] absl::StatusOr<std::size_t> Run(std::size_t robots_max);
  [[nodiscard]] bool done() const { return done_.load(); }

 private:
  /// Tells OddFleets the names of fleets whose robots were not read.
  absl::Status KnowOtherFleets() const;
  void RestoreSession(const storage::RobotRow& row) const;
  void Take(robot::Robot& robot, const storage::RobotRow& row) const;

  const Context context_;
  std::atomic<bool> done_{false};
};

}  // namespace uplink::store
