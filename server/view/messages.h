#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "server/view/parts.h"
#include "server/view/queries.h"
#include "server/view/text_members.h"
#include "storage/reader.h"
#include "uplink/v1/fleet.pb.h"

namespace uplink::view {

// Values of the queries as messages of the fleet contract, for every transport. Members of type
// Struct are not set: TextsOf gives them as texts, by their names in JSON. Pure.

[[nodiscard]] v1::Robot ToMessage(const RobotView& robot);
[[nodiscard]] TextMembers TextsOf(const RobotView& robot, const PartSet& parts);

[[nodiscard]] v1::Fleet ToMessage(const FleetView& fleet);
[[nodiscard]] v1::TopRobot ToMessage(const fleet::TopSenders::Sender& sender);
[[nodiscard]] v1::Candidate ToMessage(const fleet::Candidate& candidate);

// Rows of lists.
[[nodiscard]] v1::Fault ToMessage(const storage::FaultRow& row);
[[nodiscard]] v1::Event ToMessage(const storage::EventRow& row);
[[nodiscard]] v1::RobotMessage ToMessage(const storage::MessageRow& row);
[[nodiscard]] v1::Connection ToMessage(const storage::ConnectionRow& row);
[[nodiscard]] v1::PresenceChange ToMessage(const storage::PresenceRow& row);
[[nodiscard]] v1::Quarantined ToMessage(const storage::QuarantineRow& row);
[[nodiscard]] v1::Gap ToMessage(const storage::GapRow& row);
[[nodiscard]] v1::ScopeUpdate ToMessage(const storage::ScopeUpdateRow& row);
[[nodiscard]] v1::MissionRun ToMessage(const storage::MissionRunRow& row);
[[nodiscard]] v1::MissionReport ToMessage(const storage::MissionReportRow& row);
[[nodiscard]] v1::OperatorRequest ToMessage(const storage::OperatorRequestRow& row);
[[nodiscard]] v1::Shape ToMessage(const storage::ShapeRow& row);
[[nodiscard]] v1::TrackedObject ToMessage(const storage::ObjectRow& row);

[[nodiscard]] v1::StoryEntry ToMessage(const StoryEntry& entry);
[[nodiscard]] TextMembers TextsOf(const StoryEntry& entry);

/// For rows without a Struct.
template <typename Row>
[[nodiscard]] TextMembers TextsOf(const Row& /*row*/) {
  return {};
}
[[nodiscard]] TextMembers TextsOf(const storage::EventRow& row);
[[nodiscard]] TextMembers TextsOf(const storage::MessageRow& row);
[[nodiscard]] TextMembers TextsOf(const storage::ScopeUpdateRow& row);
[[nodiscard]] TextMembers TextsOf(const storage::MissionRunRow& row);
[[nodiscard]] TextMembers TextsOf(const storage::MissionReportRow& row);
[[nodiscard]] TextMembers TextsOf(const storage::ShapeRow& row);
[[nodiscard]] TextMembers TextsOf(const storage::ObjectRow& row);

/// `degraded` has the words of /readyz.
[[nodiscard]] v1::ServerStatus ToMessage(const StatusView& status,
                                         const std::vector<std::string>& degraded);

/// A counter as a signed field of the contract; values above its maximum become the maximum.
[[nodiscard]] std::int64_t Signed(std::uint64_t value);

}  // namespace uplink::view
