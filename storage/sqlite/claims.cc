#include "storage/sqlite/claims.h"

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "storage/open_stream.h"
#include "storage/sqlite/tables.h"

namespace uplink::storage::sqlite {

absl::StatusOr<ClaimResult> ClaimDrone(Tables& tables, const ClaimRequest& request,
                                       const ProcessId& process) {
  DecidingTables& deciding = tables.deciding;
  ClaimTables& claims = tables.claims;
  const std::string& ruri = request.robot->ruri;
  // The store is one process's at a time: none but this one goes on holding the robot.
  OpenRequest open;
  open.robot = request.robot;
  open.at = request.at;
  ClaimResult result;
  absl::StatusOr<std::optional<std::string>> other_fleet = deciding.OtherFleet(open);
  if (!other_fleet.ok()) return other_fleet.status();
  if (*other_fleet && request.fleet_word == FleetWord::kMatches) {
    result.other_fleet = *std::move(other_fleet);
    return result;
  }
  const absl::StatusOr<OpenedRobot> robot = deciding.OpenRobot(open, process);
  if (!robot.ok()) return robot.status();
  absl::Status claimed = claims.Claim(request, {process, robot->epoch});
  if (!claimed.ok()) return claimed;
  result.claim = robot->epoch;
  result.moved_from = *std::move(other_fleet);
  result.was_known = robot->was_known;
  result.held_since = robot->held_since;
  const auto presence = deciding.Presence(ruri);
  if (!presence.ok()) return presence.status();
  result.presence = *presence;
  const auto latest_kinds = deciding.LatestKinds(ruri);
  if (!latest_kinds.ok()) return latest_kinds.status();
  result.latest_kinds = *latest_kinds;
  absl::StatusOr<std::vector<SampleMemory>> samples = claims.AllSamples(ruri);
  if (!samples.ok()) return samples.status();
  result.samples = *std::move(samples);
  return result;
}

}  // namespace uplink::storage::sqlite
