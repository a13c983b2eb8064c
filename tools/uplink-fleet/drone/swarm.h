#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <absl/status/statusor.h>

#include "tools/uplink-fleet/drone/group.h"
#include "tools/uplink-fleet/robot/swarm.h"

namespace uplink::synthetic {

/// All drones of a run, and the threads that drive them. Their certificates are made in memory.
///
/// Thread: confined to main's; owns those of the groups.
class DroneSwarm final {
 public:
  /// `options` names the server, the fleet, the number of threads and the scenario; its first
  /// phase says seed and run. All references outlive the swarm.
  ///
  /// Errors: those of the pki folder.
  [[nodiscard]] static absl::StatusOr<std::unique_ptr<DroneSwarm>> Create(
      const SwarmOptions& options, const Clock& clock, DronesShared& shared);
  /// Gives up what still goes on.
  ~DroneSwarm();
  DroneSwarm(const DroneSwarm&) = delete;
  DroneSwarm& operator=(const DroneSwarm&) = delete;

  void Start();
  /// Waits for the groups, which end with the stage kClose, or are told to give up.
  void Finish() { threads_.clear(); }
  [[nodiscard]] std::size_t groups() const { return groups_.size(); }
  /// Calls `each` for every drone. Its group must be quiet (told by `quiet_groups`) or finished.
  void ForEach(const std::function<void(const DroneScript&)>& each) const;
  /// Of all drones; after Finish.
  [[nodiscard]] Latencies TakeLatencies() const;

 private:
  explicit DroneSwarm(DronesShared& shared) : shared_(shared) {}

  DronesShared& shared_;
  std::vector<std::unique_ptr<DroneGroup>> groups_;
  std::vector<std::jthread> threads_;
};

}  // namespace uplink::synthetic
