#pragma once

#include <array>
#include <string>
#include <vector>

#include "tools/uplink-fleet/compare/stored_robot.h"
#include "tools/uplink-fleet/twin/account.h"
#include "uplink/v1/fleet.pb.h"

namespace uplink::synthetic {

/// What the server showed of a twin at the end. A value.
struct StoredTwin {
  /// Rows of its two robots, by Side.
  std::array<StoredRobot, kSides> robots;
  /// Of its environment and its workflow run.
  std::vector<v1::ScopeUpdate> scopes;

  [[nodiscard]] const StoredRobot& Of(Side side) const {
    return robots.at(static_cast<std::size_t>(side));
  }
};

/// `GET /api/v1/robots/{ruri}` of its two robots while the link was quiet, by Side, as the server
/// wrote it; empty: no such robot.
using TwinLook = std::array<std::string, kSides>;

}  // namespace uplink::synthetic
