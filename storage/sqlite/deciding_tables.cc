#include "storage/sqlite/deciding_tables.h"

#include "schema/base/check.h"
#include "storage/read_row.h"

namespace uplink::storage::sqlite {
namespace {

absl::StatusOr<std::uint64_t> Unsigned(const absl::StatusOr<std::int64_t>& number) {
  if (!number.ok()) return number.status();
  return static_cast<std::uint64_t>(*number);
}

/// The row of an upsert, which always returns it.
template <typename Made>
absl::StatusOr<Made> Upserted(absl::StatusOr<std::optional<Made>> row) {
  if (!row.ok()) return row.status();
  UPLINK_CHECK(row->has_value(), "an upsert returns its row");
  return **row;
}

SessionCursor CursorIn(const Rows& row) { return {NumberIn(row, 0), NumberIn(row, 1)}; }

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
  prepare.Into(presence_,
               "SELECT presence, changed_at, parked_until FROM presence_latest WHERE ruri = ?");
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
  prepare.Into(lease_epoch_,
               "SELECT epoch FROM topic_clients WHERE client_id = ?1 AND process = ?2");
  prepare.Into(insert_delivery_,
               "INSERT INTO deliveries (client_id, number, packet_id, digest) VALUES (?, ?, ?, ?)"
               " ON CONFLICT (client_id, number) DO NOTHING");
  prepare.Into(erase_delivery_, "DELETE FROM deliveries WHERE client_id = ? AND number = ?");
  return prepare.status();
}

absl::StatusOr<EntryNumber> DecidingTables::NextEntry() {
  return Unsigned(next_entry_->Select().OnlyInt());
}

absl::Status DecidingTables::SetNextEntry(EntryNumber next) { return set_next_entry_->Run(next); }

absl::StatusOr<Epoch> DecidingTables::DrawEpoch() {
  return Unsigned(draw_epoch_->Select().OnlyInt());
}

absl::StatusOr<std::optional<std::string>> DecidingTables::OtherFleet(const OpenRequest& request) {
  auto fleet =
      fleet_->Select(request.robot->ruri).First([](const Rows& row) { return TextIn(row, 0); });
  if (fleet.ok() && *fleet == request.robot->fleet) return std::optional<std::string>();
  return fleet;
}

absl::StatusOr<OpenedRobot> DecidingTables::OpenRobot(const OpenRequest& request,
                                                      const ProcessId& process) {
  const absl::StatusOr<std::optional<RobotHold>> known = HoldOf(request.robot->ruri);
  if (!known.ok()) return known.status();
  const absl::StatusOr<Epoch> epoch = DrawEpoch();
  if (!epoch.ok()) return epoch.status();
  return Upserted(
      open_robot_->Select(request.robot->ruri, request.robot->fleet, process, request.at, *epoch)
          .First([&known](const Rows& row) {
            return OpenedRobot{known->has_value(), NumberIn(row, 0), NumberIn(row, 1)};
          }));
}

absl::StatusOr<AdoptResult> DecidingTables::AdoptRobot(const AdoptRequest& request,
                                                       const ProcessId& process) {
  const absl::StatusOr<Epoch> epoch = DrawEpoch();
  if (!epoch.ok()) return epoch.status();
  const std::int64_t silent{request.end == HolderEnd::kSilent};
  const auto adopted =
      adopt_robot_->Select(request.robot->ruri, request.holder, process, silent, *epoch)
          .First([](const Rows& row) {
            AdoptResult result;
            result.held_since = NumberIn(row, 0);
            result.end = row.Bool(1) ? HolderEnd::kSilent : HolderEnd::kEnded;
            return result;
          });
  if (!adopted.ok()) return adopted.status();
  return adopted->value_or(AdoptResult());
}

absl::StatusOr<std::optional<StoredPresence>> DecidingTables::Presence(std::string_view ruri) {
  return presence_->Select(ruri).First([](const Rows& row) { return *PresenceIn(row, 0); });
}

absl::StatusOr<LatestKindSet> DecidingTables::LatestKinds(std::string_view ruri) {
  LatestKindSet kinds = 0;
  absl::Status read = latest_kinds_->Select(ruri).ForEach(
      [&kinds](const Rows& row) { kinds |= BitOf(static_cast<LatestKind>(row.Int(0))); });
  if (!read.ok()) return read;
  return kinds;
}

absl::StatusOr<std::optional<RobotHold>> DecidingTables::HoldOf(std::string_view ruri) {
  return hold_->Select(ruri).First([](const Rows& row) { return *HoldIn(row, 0); });
}

absl::StatusOr<SessionCursor> DecidingTables::OpenSession(const OpenRequest& request,
                                                          EntryNumber next_entry) {
  return Upserted(open_session_
                      ->Select(request.robot->ruri, request.session, request.at, next_entry,
                               request.settled_seq)
                      .First(CursorIn));
}

absl::StatusOr<std::optional<SessionCursor>> DecidingTables::FindSession(
    std::string_view ruri, const model::SessionId& session) {
  return find_session_->Select(ruri, session).First(CursorIn);
}

absl::Status DecidingTables::RaiseCursor(std::string_view ruri, const model::SessionId& session,
                                         const SessionCursor& cursor, SystemTime last_used) {
  return raise_cursor_->Run(ruri, session, cursor.cursor, last_used, cursor.first_entry);
}

absl::StatusOr<std::vector<model::SessionId>> DecidingTables::Sessions(std::string_view ruri) {
  std::vector<model::SessionId> sessions;
  bool good = true;
  const absl::Status read = sessions_->Select(ruri).ForEach([&](const Rows& row) {
    const std::optional<model::SessionId> session = model::SessionId::FromBytes(row.Bytes(0));
    good &= session.has_value();
    if (session) sessions.push_back(*session);
  });
  if (!read.ok()) return read;
  if (!good) return absl::InternalError("a session in the store is not 16 bytes");
  return sessions;
}

absl::Status DecidingTables::DeleteSession(std::string_view ruri, const model::SessionId& session) {
  return delete_session_->Run(ruri, session);
}

absl::StatusOr<FoundRobot> DecidingTables::Compare(const ToldRobot& robot,
                                                   const ProcessId& process) {
  FoundRobot found;
  const auto hold = HoldOf(robot.ruri);
  if (!hold.ok()) return hold.status();
  if (*hold) {
    found.held = (*hold)->owner == process && (*hold)->epoch == robot.held_since;
    found.went_back = (*hold)->epoch < robot.held_since;
    if ((*hold)->epoch > robot.held_since) return found;
  }
  for (const CommittedSession& told : robot.sessions) {
    const auto session = FindSession(robot.ruri, told.session);
    if (!session.ok()) return session.status();
    if ((*session ? (*session)->cursor : 0) < told.cursor) found.went_back = true;
  }
  if (!found.held) return found;
  const auto presence = Presence(robot.ruri);
  if (!presence.ok()) return presence.status();
  found.presence = *presence;
  return found;
}

absl::StatusOr<Epoch> DecidingTables::LeaseEpoch(std::string_view client_id,
                                                 const ProcessId& process) {
  const auto epoch = lease_epoch_->Select(client_id, process).First([](const Rows& row) {
    return static_cast<Epoch>(row.Int(0));
  });
  if (!epoch.ok()) return epoch.status();
  return epoch->value_or(Epoch{0});
}

absl::Status DecidingTables::Remember(const DeliveryChanges& changes) {
  for (const auto& [hold, delivery] : changes.added) {
    absl::Status added = insert_delivery_->Run(hold->client_id, delivery.number,
                                               std::int64_t{delivery.packet_id}, delivery.digest);
    if (!added.ok()) return added;
  }
  for (const auto& [hold, number] : changes.gone) {
    absl::Status erased = erase_delivery_->Run(hold->client_id, number);
    if (!erased.ok()) return erased;
  }
  return absl::OkStatus();
}

}  // namespace uplink::storage::sqlite
