#pragma once

#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "schema/base/clock.h"
#include "schema/model/ids.h"
#include "storage/adopt.h"
#include "storage/compare.h"
#include "storage/epoch.h"
#include "storage/identity.h"
#include "storage/latest_kind.h"
#include "storage/open_stream.h"
#include "storage/origin.h"
#include "storage/presence.h"
#include "storage/remember.h"
#include "storage/robot_hold.h"
#include "storage/sqlite/database.h"
#include "storage/sqlite/statement.h"

namespace uplink::storage::sqlite {

/// A robot's row after a stream was opened.
struct OpenedRobot {
  /// The row was there before.
  bool was_known = false;
  Epoch epoch = 0;
  Epoch held_since = 0;
};

/// A session's row.
struct SessionCursor {
  model::Seq cursor = 0;
  /// Quarantine rows of the session begin here.
  EntryNumber first_entry = 0;
};

/// The rows of robots, sessions, leases on topics and the count of entries: what decides; and what
/// is remembered of deliveries.
///
/// Errors: those of errors.h. Thread: confined to the thread of its database.
class DecidingTables final {
 public:
  [[nodiscard]] absl::Status Prepare(Database& database);

  [[nodiscard]] absl::StatusOr<EntryNumber> NextEntry();
  [[nodiscard]] absl::Status SetNextEntry(EntryNumber next);

  [[nodiscard]] absl::StatusOr<OpenedRobot> OpenRobot(const OpenRequest& request,
                                                      const ProcessId& process);
  /// All but the presence. No hold if the request's holder does not hold the robot any more.
  [[nodiscard]] absl::StatusOr<AdoptResult> AdoptRobot(const AdoptRequest& request,
                                                       const ProcessId& process);
  /// Nothing if there is no such row.
  [[nodiscard]] absl::StatusOr<std::optional<StoredPresence>> Presence(std::string_view ruri);
  /// As OpenResult.latest_kinds.
  [[nodiscard]] absl::StatusOr<LatestKindSet> LatestKinds(std::string_view ruri);
  /// Who holds the robot since when; nothing if there is no such row.
  [[nodiscard]] absl::StatusOr<std::optional<RobotHold>> HoldOf(std::string_view ruri);
  /// In which other fleet than the request's the robot is; nothing if it is in that one or in none.
  [[nodiscard]] absl::StatusOr<std::optional<std::string>> OtherFleet(const OpenRequest& request);

  /// Creates the row if there is none; `next_entry` is its first then.
  [[nodiscard]] absl::StatusOr<SessionCursor> OpenSession(const OpenRequest& request,
                                                          EntryNumber next_entry);
  [[nodiscard]] absl::StatusOr<std::optional<SessionCursor>> FindSession(
      std::string_view ruri, const model::SessionId& session);
  /// Creates the row if there is none. Neither number of it ever falls.
  [[nodiscard]] absl::Status RaiseCursor(std::string_view ruri, const model::SessionId& session,
                                         const SessionCursor& cursor, SystemTime last_used);
  /// A robot's sessions, least recently used first.
  [[nodiscard]] absl::StatusOr<std::vector<model::SessionId>> Sessions(std::string_view ruri);
  [[nodiscard]] absl::Status DeleteSession(std::string_view ruri, const model::SessionId& session);

  /// 0 if the client id has no lease, or another process has it.
  [[nodiscard]] absl::StatusOr<Epoch> LeaseEpoch(std::string_view client_id,
                                                 const ProcessId& process);
  [[nodiscard]] absl::Status Remember(const DeliveryChanges& changes);

  /// As Store::Compare, of one robot.
  [[nodiscard]] absl::StatusOr<FoundRobot> Compare(const ToldRobot& robot,
                                                   const ProcessId& process);

 private:
  /// One that was never given, above all that were.
  [[nodiscard]] absl::StatusOr<Epoch> DrawEpoch();

  std::unique_ptr<Statement> next_entry_, set_next_entry_, draw_epoch_, open_robot_, adopt_robot_,
      presence_, latest_kinds_, hold_, fleet_, open_session_, find_session_, raise_cursor_,
      sessions_, delete_session_, lease_epoch_, insert_delivery_, erase_delivery_;
};

}  // namespace uplink::storage::sqlite
