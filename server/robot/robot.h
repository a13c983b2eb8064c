#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <mutex>
#include <span>
#include <string>
#include <string_view>

#include "schema/base/clock.h"
#include "server/robot/commit_client.h"
#include "server/robot/robot_sessions.h"
#include "server/robot/robot_state.h"
#include "storage/types.h"

namespace uplink::robot {

/// Told of each change of a robot's presence, a robot's in order. Called on any thread, under a
/// lock of the robot: short, and never back into the fleet.
using PresenceChanged =
    std::function<void(const storage::RobotRef& robot, Presence presence, SystemTime at)>;

/// One robot that this process knows. Never destroyed before the process ends, so plain pointers to
/// it are safe on every thread. Its parts are thread-safe. As a CommitClient it passes on what the
/// journal tells: to its sessions, and to its state what is news of its holder.
class Robot final : public CommitClient {
 public:
  /// `changed` outlives the robot.
  Robot(storage::RobotRef id, SteadyTime server_started, const Clock& clock,
        const PresenceChanged& changed);

  /// Identity now. The fleet part may change when the robot gets a certificate of another fleet.
  [[nodiscard]] storage::RobotRef id() const;
  void SetFleet(std::string_view fleet);
  [[nodiscard]] const std::string& ruri() const { return ruri_; }

  // --- CommitClient ---

  void OnHeld(const HoldNews& news) override;
  [[nodiscard]] bool HasStream() const override { return sessions.HasStream(); }
  StreamRef OnOpened(std::uint64_t open_id, const storage::OpenResult& result) override {
    return sessions.OnOpened(open_id, result);
  }
  StreamRef OnSettled(std::span<const Settled> settled, metrics::Ledger& ledger) override {
    return sessions.OnSettled(settled, ledger);
  }
  StreamRef OnGapsWritten(std::size_t count) override { return sessions.OnGapsWritten(count); }
  StreamRef OnFenced(metrics::Ledger& ledger) override;
  [[nodiscard]] std::uint64_t generation() const override { return sessions.generation(); }

  RobotState state;
  RobotSessions sessions;

 private:
  const Clock& clock_;
  const std::string ruri_;
  mutable std::mutex mutex_;
  storage::RobotRef id_;
};

}  // namespace uplink::robot
