#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "tools/uplink-fleet/ledger.h"
#include "tools/uplink-fleet/stored_robot.h"
#include "uplink/v1/fleet.pb.h"

namespace uplink::synthetic {

/// One line of the verification table. An empty cell means that this side does not say.
struct CheckRow {
  std::string what;
  std::string fleet;
  std::string server;
  std::string store;
  bool ok = false;
  /// Why not, or what was left out; empty if there is nothing to say.
  std::string note;
};

/// Everything that the comparison needs. A value.
struct Evidence {
  /// Unique to the run; rows of other runs are left out by it.
  std::string run;
  std::vector<RobotOutcome> robots;
  v1::ServerStatus before;
  v1::ServerStatus after;
  /// While the robots still moved.
  std::map<std::string, v1::Robot> live;
  std::map<std::string, StoredRobot> stored;
  std::uint64_t rules_broken = 0;
  std::string first_broken_rule;
  /// Streams were broken or refused on the way, so frames may have been lost and sent again.
  bool disturbed = false;
};

/// Compares what the fleet knows with what the server counts and what the store holds.
///
/// Thread: pure; any thread.
/// Source: protocol page, Conservation: after a restart of the server only rows and acks count.
[[nodiscard]] std::vector<CheckRow> Verify(const Evidence& evidence);

/// True if the counters began anew between the two.
[[nodiscard]] bool Restarted(const Evidence& evidence);

}  // namespace uplink::synthetic
