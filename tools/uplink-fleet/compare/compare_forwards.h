#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "tools/uplink-fleet/compare/findings.h"
#include "tools/uplink-fleet/robot/account.h"
#include "tools/uplink-fleet/robot/forward_board.h"
#include "tools/uplink-fleet/robot/forwarded_item.h"
#include "uplink/v1/fleet.pb.h"

namespace uplink::synthetic {

/// An item that a fleet's robots share.
struct SharedItem {
  std::string origin;
  std::uint64_t fingerprint = 0;
};
using SharedItems = ItemMap<SharedItem>;

/// Those of the rows that are there for other robots too: of scope fleet or world.
[[nodiscard]] SharedItems SharedOf(const std::vector<v1::Shape>& shapes,
                                   const std::vector<v1::TrackedObject>& objects);

/// What each receiver holds against what the fleet shares without its own items: the same ids with
/// the same contents. Pure; any thread.
void CompareForwards(const SharedItems& shared, const std::vector<ReceiverTable>& tables,
                     Findings& findings);

/// What one robot called a violation of the rules of forwarding. Pure; any thread.
void CompareViolations(const RobotOutcome& robot, Findings& findings);

/// The robots that items came from, against those of the fleet. Pure; any thread.
void CompareOrigins(const std::set<std::string>& origins, const std::set<std::string>& fleet,
                    Findings& findings);

}  // namespace uplink::synthetic
