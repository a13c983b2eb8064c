#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "metrics/rcan/page.h"
#include "server/rcan/named_series.h"
#include "server/rcan/series_names.h"

namespace uplink::rcan {

/// Versions of one robot that its series may name at a time; it takes further ones only as slowly
/// as other new names (rcan.robot_new_names_max).
inline constexpr std::size_t kInfosMax = 16;

/// What rcan_robot_info shows of a robot. Views of texts that outlive it.
struct RobotInfo {
  std::string_view ruri;
  std::string_view fleet;
  /// Chosen by the robot; empty: unknown.
  std::string_view software_version;
  std::string_view agent_version;
};

/// The last segment of the RURI: what people call the robot.
[[nodiscard]] std::string_view NameOf(std::string_view ruri);

/// Adds the robot's rcan_robot_info. The versions are the robot's words, and each new one is a new
/// series, so they are left empty once the robot has changed them too often. `names`: the robot's
/// versions up to the last scrape.
void AddInfo(const RobotInfo& info, SeriesNames& names, const NameRules& rules, SteadyTime now,
             metrics::rcan::SeriesPage& page);

}  // namespace uplink::rcan
