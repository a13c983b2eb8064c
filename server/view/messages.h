#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "schema/model/presence.h"
#include "server/view/parts.h"
#include "server/view/queries.h"
#include "storage/reader.h"
#include "uplink/v1/fleet.pb.h"

namespace uplink::view {

// Values of the queries as messages of the fleet contract, for every transport. Pure.

[[nodiscard]] v1::Robot ToMessage(const RobotView& robot, const PartSet& parts);
[[nodiscard]] v1::ListRobotsResponse ToMessage(const RobotsPage& page, const PartSet& parts);
[[nodiscard]] v1::Presence ToMessage(model::Presence presence);

// Lists; a store's JSON texts become Structs.
[[nodiscard]] v1::ListFaultsResponse ToMessage(const storage::Page<storage::FaultRow>& page);
[[nodiscard]] v1::ListEventsResponse ToMessage(const storage::Page<storage::EventRow>& page);
[[nodiscard]] v1::ListMessagesResponse ToMessage(const storage::Page<storage::MessageRow>& page);
[[nodiscard]] v1::ListPresenceChangesResponse ToMessage(
    const storage::Page<storage::PresenceRow>& page);
[[nodiscard]] v1::ListQuarantineResponse ToMessage(
    const storage::Page<storage::QuarantineRow>& page);
[[nodiscard]] v1::ListQuarantineResponse ToMessage(const QuarantineView& quarantine);
[[nodiscard]] v1::ListGapsResponse ToMessage(const storage::Page<storage::GapRow>& page);
[[nodiscard]] v1::ListScopeUpdatesResponse ToMessage(
    const storage::Page<storage::ScopeUpdateRow>& page);
[[nodiscard]] v1::ListMissionRunsResponse ToMessage(
    const storage::Page<storage::MissionRunRow>& page);
[[nodiscard]] v1::ListShapesResponse ToMessage(const storage::Page<storage::ShapeRow>& page);
[[nodiscard]] v1::ListObjectsResponse ToMessage(const storage::Page<storage::ObjectRow>& page);

/// `degraded` in the words of /readyz.
[[nodiscard]] v1::ServerStatus ToMessage(const StatusView& status,
                                         const std::vector<std::string>& degraded);

/// A counter as a signed field of the contract; it stops at the top.
[[nodiscard]] std::int64_t Signed(std::uint64_t value);

}  // namespace uplink::view
