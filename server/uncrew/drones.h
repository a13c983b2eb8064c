#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <random>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include <absl/status/statusor.h>

#include "metrics/ledger.h"
#include "schema/base/clock.h"
#include "server/fleet/claim.h"
#include "server/fleet/fleet.h"
#include "server/journal/shards.h"
#include "server/uncrew/drone.h"

namespace uplink::uncrew {

using DronePtr = std::shared_ptr<Drone>;

/// The drones that call this process, by RURI: one for each robot that speaks so.
///
/// Limits: limits.robots_max, since each is a robot of the fleet; one that did not call for
///         kDroneIdleMax goes.
/// Thread: thread-safe.
class Drones final {
 public:
  /// The references outlive it.
  struct Context {
    const Clock& clock;
    fleet::Fleet& fleet;
    const journal::Shards& journals;
    /// For what is settled: a page of the source's.
    metrics::Ledger& ledger;
    /// For the sessions that are drawn.
    std::uint64_t seed = 0;
  };
  explicit Drones(const Context& context) : context_(context), random_(context.seed) {}

  /// A call begins: the drone for which it speaks, admitted if it is new. Drone::Leave must follow.
  ///
  /// Errors: kResourceExhausted if the drone may have no more calls, or the server or the gateway
  ///         no more robots; kPermissionDenied if the robot is of another fleet than its gateway;
  ///         kUnauthenticated if the fleet's name is odd and new, kUnavailable while that is not
  ///         known.
  [[nodiscard]] absl::StatusOr<DronePtr> Enter(const fleet::Claim& claim);
  /// Null if it does not call here.
  [[nodiscard]] DronePtr Find(std::string_view ruri) const;
  [[nodiscard]] std::vector<DronePtr> All() const;
  /// Lets go of drones that did not call for long, and of those whose robot is to be forgotten,
  /// once nothing of them waits. Once in a while.
  void Round();
  [[nodiscard]] std::size_t size() const;

 private:
  [[nodiscard]] absl::StatusOr<fleet::RobotPtr> Admit(const fleet::Claim& claim);
  [[nodiscard]] model::SessionId DrawSession();

  const Context context_;
  mutable std::mutex mutex_;
  std::mt19937_64 random_;
  std::unordered_map<std::string, DronePtr> drones_;
};

}  // namespace uplink::uncrew
