#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "schema/model/ids.h"
#include "schema/model/rejection.h"
#include "schema/model/reports.h"
#include "storage/present.h"
#include "storage/sqlite/database.h"
#include "storage/sqlite/entry_number.h"
#include "storage/sqlite/kind_tables.h"
#include "storage/sqlite/live_table.h"
#include "storage/sqlite/present_rows.h"
#include "storage/sqlite/retention_tables.h"
#include "storage/sqlite/spatial_tables.h"
#include "storage/sqlite/statement.h"
#include "storage/types.h"

namespace uplink::storage::sqlite {

/// A robot's row after a stream was opened.
struct OpenedRobot {
  Epoch epoch = 0;
  Epoch held_since = 0;
};

/// A session's row.
struct SessionCursor {
  model::Seq cursor = 0;
  /// Quarantine rows of the session begin here.
  EntryNumber first_entry = 0;
};

/// The rows of robots, sessions and the count of entries: what decides.
///
/// Errors, here and below: those of errors.h. Thread: confined to the thread of its database.
class DecidingTables final {
 public:
  [[nodiscard]] absl::Status Prepare(Database& database);

  [[nodiscard]] absl::StatusOr<EntryNumber> NextEntry();
  [[nodiscard]] absl::Status SetNextEntry(EntryNumber next);

  [[nodiscard]] absl::StatusOr<OpenedRobot> OpenRobot(const OpenRequest& request,
                                                      const ProcessId& process);
  /// Nothing if there is no such row.
  [[nodiscard]] absl::StatusOr<std::optional<Epoch>> HeldSince(std::string_view ruri);
  /// For a robot that the store lost.
  [[nodiscard]] absl::Status InsertRobot(const model::RobotId& robot, Epoch held_since,
                                         SystemTime at, const ProcessId& process);

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

 private:
  std::unique_ptr<Statement> next_entry_, set_next_entry_, open_robot_, held_since_, insert_robot_,
      open_session_, find_session_, raise_cursor_, sessions_, delete_session_;
};

/// Faults: every report, and the raises of those that are active.
class FaultTables final {
 public:
  [[nodiscard]] absl::Status Prepare(Database& database);

  [[nodiscard]] absl::Status InsertHistory(const CommitRecord& record, const model::Fault& fault,
                                           EntryNumber entry);
  /// Keeps when and as which entry the fault was raised, if it is active already.
  [[nodiscard]] absl::Status Raise(const CommitRecord& record, const model::Fault& fault,
                                   EntryNumber entry);

 private:
  std::unique_ptr<Statement> insert_history_, raise_;
};

/// Which numbers of a session to read quarantine for.
struct RejectRange {
  std::string_view ruri;
  model::SessionId session;
  EntryNumber first_entry = 0;
  /// Not included.
  model::Seq above = 0;
  /// Included.
  model::Seq through = 0;
};

/// Quarantine and gaps: what did not become a record.
class SetAsideTables final {
 public:
  [[nodiscard]] absl::Status Prepare(Database& database);

  /// Leaves out the payload, then the texts, where the database refuses a row with them.
  [[nodiscard]] absl::Status Insert(const CommitRecord& record, const model::Rejection& rejection,
                                    EntryNumber entry);
  /// The first `rejects_max` of the range, ascending.
  [[nodiscard]] absl::StatusOr<std::vector<StoredReject>> Rejects(const RejectRange& range,
                                                                  std::size_t rejects_max);
  /// Drops the oldest payloads of the robot over kQuarantinePayloadsPerRobotMax.
  [[nodiscard]] absl::Status ThinPayloads(std::string_view ruri);

  [[nodiscard]] absl::Status UpsertGap(const GapItem& gap, EntryNumber entry);
  /// Deletes the oldest gaps of the robot over kGapsPerRobotMax.
  [[nodiscard]] absl::Status TrimGaps(std::string_view ruri);

 private:
  std::unique_ptr<Statement> insert_, rejects_, count_payloads_, thin_, upsert_gap_, count_gaps_,
      trim_gaps_;
};

/// All tables of one writer, their statements prepared once.
struct Tables {
  DecidingTables deciding;
  FaultTables faults;
  SetAsideTables set_aside;
  HistoryTables history;
  MissionTables missions;
  SpatialTables spatial;
  /// By PresentKind.
  std::array<PresentRows, kPresentKinds> present;
  LatestTable latest;
  PresenceTable presence;
  RetentionTables retention;
  LiveTable live;

  [[nodiscard]] absl::Status Prepare(Database& database);
  [[nodiscard]] PresentRows& present_rows(PresentKind kind) {
    return present[static_cast<std::size_t>(kind)];
  }
};

}  // namespace uplink::storage::sqlite
