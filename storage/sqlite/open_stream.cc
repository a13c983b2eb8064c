#include "storage/sqlite/open_stream.h"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "storage/bounds.h"
#include "storage/sqlite/tables.h"

namespace uplink::storage::sqlite {
namespace {

/// Deletes the robot's least recently used sessions over the bound, but none that the process
/// holds.
absl::Status EvictSessions(Tables& tables, const OpenRequest& request) {
  DecidingTables& deciding = tables.deciding;
  const auto sessions = deciding.Sessions(request.robot->ruri);
  if (!sessions.ok()) return sessions.status();
  std::size_t kept = sessions->size();
  for (const model::SessionId& session : *sessions) {
    if (kept <= kSessionsPerRobotMax) break;
    if (session == request.session) continue;
    if (std::ranges::find(request.sessions_held, session) != request.sessions_held.end()) continue;
    absl::Status deleted = deciding.DeleteSession(request.robot->ruri, session);
    if (deleted.ok()) {
      deleted = tables.set_aside.ForgetKept(request.robot->ruri, session, model::kSeqMax);
    }
    if (!deleted.ok()) return deleted;
    --kept;
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<OpenResult> OpenStream(Tables& tables, const OpenRequest& request,
                                      const ProcessId& process) {
  DecidingTables& deciding = tables.deciding;
  absl::StatusOr<std::optional<std::string>> other_fleet = deciding.OtherFleet(request);
  if (!other_fleet.ok()) return other_fleet.status();
  if (*other_fleet && request.fleet_word == FleetWord::kMatches) {
    OpenResult refused;
    refused.taken = false;
    refused.other_fleet = *std::move(other_fleet);
    return refused;
  }
  const absl::StatusOr<OpenedRobot> robot = deciding.OpenRobot(request, process);
  if (!robot.ok()) return robot.status();
  const absl::StatusOr<EntryNumber> next_entry = deciding.NextEntry();
  if (!next_entry.ok()) return next_entry.status();
  const absl::StatusOr<SessionCursor> session = deciding.OpenSession(request, *next_entry);
  if (!session.ok()) return session.status();

  OpenResult result;
  result.moved_from = *std::move(other_fleet);
  result.was_known = robot->was_known;
  result.epoch = robot->epoch;
  result.held_since = robot->held_since;
  result.cursor = session->cursor;
  RejectRange range;
  range.ruri = request.robot->ruri;
  range.session = request.session;
  range.first_entry = session->first_entry;
  range.above = std::min(request.settled_seq, session->cursor);
  range.through = session->cursor;
  absl::StatusOr<std::vector<StoredReject>> rejects =
      tables.set_aside.Rejects(range, request.rejects_max);
  if (!rejects.ok()) return rejects.status();
  result.rejects = *std::move(rejects);
  const auto total = tables.set_aside.CountRejects(range, kQuarantineRowsPerRobotMax);
  if (!total.ok()) return total.status();
  result.rejects_total = *total;
  // Without a number yet the session is new: what is kept by its id is of one that went.
  absl::Status forgot = tables.set_aside.ForgetKept(
      range.ruri, range.session, range.through == 0 ? model::kSeqMax : range.above);
  if (forgot.ok()) forgot = EvictSessions(tables, request);
  if (!forgot.ok()) return forgot;
  const auto presence = deciding.Presence(request.robot->ruri);
  if (!presence.ok()) return presence.status();
  result.presence = *presence;
  const auto latest_kinds = deciding.LatestKinds(request.robot->ruri);
  if (!latest_kinds.ok()) return latest_kinds.status();
  result.latest_kinds = *latest_kinds;
  return result;
}

}  // namespace uplink::storage::sqlite
