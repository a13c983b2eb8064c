#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "schema/base/clock.h"
#include "server/cyberwave/twins.h"
#include "server/robot/robot.h"
#include "server/uncrew/drones.h"
#include "server/view/vitals.h"

namespace uplink::view {

/// What lists filter and order robots by: the few values that are cheap to take of each of them.
/// What is unknown is empty. A value.
struct Glance {
  Vitals vitals{};
  /// Its status says so.
  bool faulted = false;
  std::optional<SystemTime> last_heard{};
  /// Messages that wait at its agent.
  std::optional<std::uint64_t> backlog{};
  /// Of its connection, else as it reported.
  std::string agent_version{};
  std::string software_version{};
  std::optional<SystemTime> certificate_not_after{};
};

/// Where a robot's live values are beside its state; null: no such source.
struct LiveSources {
  const cyberwave::Twins* twins = nullptr;
  const uncrew::Drones* drones = nullptr;
};

/// What this process knows about the robot: nearly nothing of one that another process holds. Takes
/// some locks one after the other, each for a moment.
///
/// Thread: any.
[[nodiscard]] Glance GlanceOf(const robot::Robot& robot, const LiveSources& sources);

}  // namespace uplink::view
