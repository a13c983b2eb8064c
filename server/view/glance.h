#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>

#include "schema/base/clock.h"
#include "server/cyberwave/twins.h"
#include "server/robot/robot.h"
#include "server/uncrew/drones.h"
#include "server/view/vitals.h"

namespace uplink::view {

/// What lists filter and order robots by: the few values that are cheap to take of each of them.
/// What is unknown is empty. A value.
struct Glance {
  /// Another process holds it, and may know what is empty here.
  bool foreign = false;
  Vitals vitals{};
  /// Whether its status says so; without a status false.
  std::optional<bool> faulted{};
  std::optional<SystemTime> last_heard{};
  /// Messages that wait at its agent.
  std::optional<std::uint64_t> backlog{};
  /// Of its connection, else as it reported.
  std::string agent_version{};
  std::string software_version{};
  std::optional<SystemTime> certificate_not_after{};
  /// Whole days until then, rounded down; only of a robot that is shown.
  std::optional<std::int32_t> certificate_days_left{};
};

/// By RURI.
using GlanceMap = std::unordered_map<std::string, Glance>;

/// Where a robot's live values are beside its state; null: no such source.
struct LiveSources {
  const cyberwave::Twins* twins = nullptr;
  const uncrew::Drones* drones = nullptr;
  /// Of the robots that other processes hold.
  const GlanceMap* foreign = nullptr;
};

/// What this process knows about the robot. Takes some locks one after the other, each for a
/// moment.
///
/// Thread: any.
[[nodiscard]] Glance GlanceOf(const robot::Robot& robot, const LiveSources& sources);

/// Sets the versions that no connection told as the robot reported them. Pure.
void FillVersions(std::string_view agent, std::string_view software, Glance& glance);
/// The same from the JSON of an agentInfo.
void FillVersions(std::string_view agent_info, Glance& glance);

}  // namespace uplink::view
