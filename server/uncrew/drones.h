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

/// The drones that call this process, by RURI: one for each robot that speaks by calls.
///
/// Limits: limits.robots_max, since each is a robot of the fleet. A drone that did not call for
///         kDroneIdleMax is dropped.
/// Thread: thread-safe.
class Drones final {
 public:
  /// The references outlive it.
  struct Context {
    const Clock& clock;
    fleet::Fleet& fleet;
    const journal::Shards& journals;
    /// Counts settled samples: a page of the source's.
    metrics::Ledger& ledger;
    /// For drawing sessions.
    std::uint64_t seed = 0;
  };
  explicit Drones(const Context& context) : context_(context), random_(context.seed) {}

  /// A call begins. Returns the drone that it speaks for, admitted if new; Drone::Leave must
  /// follow.
  ///
  /// Errors: kResourceExhausted if the drone may have no more calls, or the server or the gateway
  ///         no more robots; kPermissionDenied if the robot is of another fleet than its gateway;
  ///         kUnauthenticated if the fleet's name is odd and new, kUnavailable while that is
  ///         unknown; those of fleet::StatusOfEntry.
  [[nodiscard]] absl::StatusOr<DronePtr> Enter(const fleet::Claim& claim);
  /// Null if it does not call here.
  [[nodiscard]] DronePtr Find(std::string_view ruri) const;
  [[nodiscard]] std::vector<DronePtr> All() const;
  /// Drops drones that did not call for long, or whose robot an operator wants to forget, once none
  /// of their samples wait. Call it repeatedly.
  void Round();
  [[nodiscard]] std::size_t size() const;

 private:
  [[nodiscard]] absl::StatusOr<fleet::Fleet::Admission> Admit(const fleet::Claim& claim);
  [[nodiscard]] model::SessionId DrawSession();

  const Context context_;
  mutable std::mutex mutex_;
  std::mt19937_64 random_;
  std::unordered_map<std::string, DronePtr> drones_;
};

}  // namespace uplink::uncrew
