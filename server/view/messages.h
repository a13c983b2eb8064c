#pragma once

#include <string>
#include <vector>

#include "server/view/parts.h"
#include "server/view/queries.h"
#include "storage/reader.h"
#include "uplink/v1/fleet.pb.h"

namespace uplink::view {

// Values of the queries as messages of the fleet contract, for every transport. Pure.

[[nodiscard]] v1::Robot ToMessage(const RobotView& robot, const PartSet& parts);
[[nodiscard]] v1::ListRobotsResponse ToMessage(const RobotsPage& page, const PartSet& parts);
[[nodiscard]] v1::ListFaultsResponse ToMessage(const storage::Page<storage::FaultRow>& page);
[[nodiscard]] v1::ListQuarantineResponse ToMessage(
    const storage::Page<storage::QuarantineRow>& page);
[[nodiscard]] v1::ListGapsResponse ToMessage(const storage::Page<storage::GapRow>& page);
/// `degraded` in the words of /readyz.
[[nodiscard]] v1::ServerStatus ToMessage(const StatusView& status,
                                         const std::vector<std::string>& degraded);

}  // namespace uplink::view
