#include "storage/sqlite/deciding_tables.h"

#include <algorithm>

#include "schema/base/check.h"
#include "storage/numbers.h"
#include "storage/sqlite/prepare.h"

namespace uplink::storage::sqlite {
namespace {

Blob BlobOf(const model::SessionId& session) { return {session.AsBytes()}; }

Blob BlobOf(const ProcessId& process) {
  return {std::string_view(reinterpret_cast<const char*>(process.data()), process.size())};
}

std::uint64_t Unsigned(std::int64_t column) { return static_cast<std::uint64_t>(column); }

}  // namespace

absl::Status DecidingTables::Prepare(Database& database) {
  Preparer prepare(database);
  prepare.Into(next_entry_, "SELECT next_entry FROM entries WHERE id = 0");
  prepare.Into(set_next_entry_, "UPDATE entries SET next_entry = ? WHERE id = 0");
  prepare.Into(draw_epoch_, "UPDATE epochs SET last = last + 1 WHERE id = 0 RETURNING last");
  // The right sides of an update see the row as it was.
  prepare.Into(open_robot_,
               "INSERT INTO robots (ruri, fleet, epoch, held_since, owner, first_seen,"
               " last_seen) VALUES (?1, ?2, ?5, ?5, ?3, ?4, ?4)"
               " ON CONFLICT (ruri) DO UPDATE SET fleet = excluded.fleet, epoch = excluded.epoch,"
               " held_since = iif(owner = excluded.owner, held_since, excluded.epoch),"
               " owner = excluded.owner, holder_silent = 0,"
               " last_seen = max(last_seen, excluded.last_seen)"
               " RETURNING epoch, held_since");
  prepare.Into(adopt_robot_,
               "UPDATE robots SET epoch = iif(owner = ?3, epoch, ?5),"
               " held_since = iif(owner = ?3, held_since, ?5),"
               " holder_silent = max(holder_silent, ?4 AND owner <> ?3), owner = ?3"
               " WHERE ruri = ?1 AND owner IN (?2, ?3) RETURNING held_since, holder_silent");
  prepare.Into(presence_, "SELECT presence, changed_at FROM presence_latest WHERE ruri = ?");
  prepare.Into(latest_kinds_, "SELECT kind FROM latest WHERE ruri = ?");
  prepare.Into(hold_, "SELECT owner, held_since FROM robots WHERE ruri = ?");
  prepare.Into(fleet_, "SELECT fleet FROM robots WHERE ruri = ?");
  prepare.Into(open_session_,
               "INSERT INTO sessions (ruri, session, cursor_seq, last_used, first_entry)"
               " VALUES (?1, ?2, 0, ?3, ?4) ON CONFLICT (ruri, session) DO UPDATE"
               " SET last_used = max(last_used, excluded.last_used),"
               " settled_seq = max(settled_seq, min(?5, cursor_seq))"
               " RETURNING cursor_seq, first_entry");
  prepare.Into(find_session_,
               "SELECT cursor_seq, first_entry FROM sessions WHERE ruri = ? AND session = ?");
  prepare.Into(raise_cursor_,
               "INSERT INTO sessions (ruri, session, cursor_seq, last_used, first_entry)"
               " VALUES (?, ?, ?, ?, ?) ON CONFLICT (ruri, session) DO UPDATE"
               " SET cursor_seq = max(cursor_seq, excluded.cursor_seq),"
               " last_used = max(last_used, excluded.last_used)");
  prepare.Into(sessions_,
               "SELECT session FROM sessions WHERE ruri = ? ORDER BY last_used, session");
  prepare.Into(delete_session_, "DELETE FROM sessions WHERE ruri = ? AND session = ?");
  return prepare.status();
}

absl::StatusOr<EntryNumber> DecidingTables::NextEntry() {
  Rows rows = next_entry_->Select();
  const absl::StatusOr<bool> found = rows.Next();
  if (!found.ok()) return found.status();
  if (!*found) return absl::InternalError("the store's count of entries is gone");
  return Unsigned(rows.Int(0));
}

absl::Status DecidingTables::SetNextEntry(EntryNumber next) { return set_next_entry_->Run(next); }

absl::StatusOr<Epoch> DecidingTables::DrawEpoch() {
  Rows rows = draw_epoch_->Select();
  const absl::StatusOr<bool> found = rows.Next();
  if (!found.ok()) return found.status();
  if (!*found) return absl::InternalError("the store's count of epochs is gone");
  return Unsigned(rows.Int(0));
}

absl::StatusOr<std::optional<std::string>> DecidingTables::OtherFleet(const OpenRequest& request) {
  Rows rows = fleet_->Select(std::string_view(request.robot->ruri));
  const absl::StatusOr<bool> found = rows.Next();
  if (!found.ok()) return found.status();
  if (!*found || rows.Bytes(0) == request.robot->fleet) return std::optional<std::string>();
  return std::optional(std::string(rows.Bytes(0)));
}

absl::StatusOr<OpenedRobot> DecidingTables::OpenRobot(const OpenRequest& request,
                                                      const ProcessId& process) {
  const absl::StatusOr<std::optional<RobotHold>> known = HoldOf(request.robot->ruri);
  if (!known.ok()) return known.status();
  const absl::StatusOr<Epoch> epoch = DrawEpoch();
  if (!epoch.ok()) return epoch.status();
  Rows rows = open_robot_->Select(std::string_view(request.robot->ruri),
                                  std::string_view(request.robot->fleet), BlobOf(process),
                                  UnixMs(request.at), *epoch);
  const absl::StatusOr<bool> found = rows.Next();
  if (!found.ok()) return found.status();
  UPLINK_CHECK(*found, "an upsert returns its row");
  return OpenedRobot{known->has_value(), Unsigned(rows.Int(0)), Unsigned(rows.Int(1))};
}

absl::StatusOr<AdoptResult> DecidingTables::AdoptRobot(const AdoptRequest& request,
                                                       const ProcessId& process) {
  const absl::StatusOr<Epoch> epoch = DrawEpoch();
  if (!epoch.ok()) return epoch.status();
  Rows rows = adopt_robot_->Select(std::string_view(request.robot->ruri), BlobOf(request.holder),
                                   BlobOf(process), std::int64_t{request.end == HolderEnd::kSilent},
                                   *epoch);
  const absl::StatusOr<bool> found = rows.Next();
  if (!found.ok()) return found.status();
  AdoptResult result;
  if (!*found) return result;
  result.held_since = Unsigned(rows.Int(0));
  result.end = rows.Int(1) != 0 ? HolderEnd::kSilent : HolderEnd::kEnded;
  return result;
}

absl::StatusOr<std::optional<StoredPresence>> DecidingTables::Presence(std::string_view ruri) {
  Rows rows = presence_->Select(ruri);
  const absl::StatusOr<bool> found = rows.Next();
  if (!found.ok()) return found.status();
  if (!*found) return std::optional<StoredPresence>();
  return std::optional(StoredPresence{PresenceOf(rows.Int(0)), FromUnixMs(rows.Int(1))});
}

absl::StatusOr<LatestKindSet> DecidingTables::LatestKinds(std::string_view ruri) {
  LatestKindSet kinds = 0;
  Rows rows = latest_kinds_->Select(ruri);
  while (true) {
    const absl::StatusOr<bool> found = rows.Next();
    if (!found.ok()) return found.status();
    if (!*found) return kinds;
    kinds |= BitOf(static_cast<LatestKind>(rows.Int(0)));
  }
}

absl::StatusOr<std::optional<RobotHold>> DecidingTables::HoldOf(std::string_view ruri) {
  Rows rows = hold_->Select(ruri);
  const absl::StatusOr<bool> found = rows.Next();
  if (!found.ok()) return found.status();
  if (!*found) return std::optional<RobotHold>();
  RobotHold hold{.owner = {}, .epoch = Unsigned(rows.Int(1))};
  const std::string_view owner = rows.Bytes(0);
  if (owner.size() == hold.owner.size()) std::ranges::copy(owner, hold.owner.begin());
  return std::optional(hold);
}

absl::StatusOr<SessionCursor> DecidingTables::OpenSession(const OpenRequest& request,
                                                          EntryNumber next_entry) {
  Rows rows = open_session_->Select(std::string_view(request.robot->ruri), BlobOf(request.session),
                                    UnixMs(request.at), next_entry, request.settled_seq);
  const absl::StatusOr<bool> found = rows.Next();
  if (!found.ok()) return found.status();
  UPLINK_CHECK(*found, "an upsert returns its row");
  return SessionCursor{Unsigned(rows.Int(0)), Unsigned(rows.Int(1))};
}

absl::StatusOr<std::optional<SessionCursor>> DecidingTables::FindSession(
    std::string_view ruri, const model::SessionId& session) {
  Rows rows = find_session_->Select(ruri, BlobOf(session));
  const absl::StatusOr<bool> found = rows.Next();
  if (!found.ok()) return found.status();
  if (!*found) return std::optional<SessionCursor>();
  return std::optional<SessionCursor>({Unsigned(rows.Int(0)), Unsigned(rows.Int(1))});
}

absl::Status DecidingTables::RaiseCursor(std::string_view ruri, const model::SessionId& session,
                                         const SessionCursor& cursor, SystemTime last_used) {
  return raise_cursor_->Run(ruri, BlobOf(session), cursor.cursor, UnixMs(last_used),
                            cursor.first_entry);
}

absl::StatusOr<std::vector<model::SessionId>> DecidingTables::Sessions(std::string_view ruri) {
  std::vector<model::SessionId> sessions;
  Rows rows = sessions_->Select(ruri);
  while (true) {
    const absl::StatusOr<bool> found = rows.Next();
    if (!found.ok()) return found.status();
    if (!*found) return sessions;
    const std::optional<model::SessionId> session = model::SessionId::FromBytes(rows.Bytes(0));
    if (!session) return absl::InternalError("a session in the store is not 16 bytes");
    sessions.push_back(*session);
  }
}

absl::Status DecidingTables::DeleteSession(std::string_view ruri, const model::SessionId& session) {
  return delete_session_->Run(ruri, BlobOf(session));
}

}  // namespace uplink::storage::sqlite
