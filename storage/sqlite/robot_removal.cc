#include "storage/sqlite/robot_removal.h"

#include <utility>

#include "storage/kept_tables.h"
#include "storage/sqlite/counts.h"
#include "storage/sqlite/prepare.h"
#include "storage/sqlite/robot_hold.h"

namespace uplink::storage::sqlite {
absl::StatusOr<std::unique_ptr<SqliteRobotRemoval>> SqliteRobotRemoval::Make(Database& database) {
  std::unique_ptr<SqliteRobotRemoval> removal(new SqliteRobotRemoval(database));
  absl::Status status = removal->Prepare();
  if (!status.ok()) return status;
  return removal;
}

absl::Status SqliteRobotRemoval::Prepare() {
  Preparer prepare(database_);
  prepare.Into(begin_, "BEGIN IMMEDIATE");
  prepare.Into(commit_, "COMMIT");
  prepare.Into(hold_, "SELECT owner, epoch FROM robots WHERE ruri = ?");
  // The store is one process's at a time: no other can have a stream.
  prepare.Into(silent_,
               "SELECT ruri, epoch FROM robots AS r WHERE last_seen < ?1"
               " AND coalesce((SELECT last_sign_at FROM live WHERE ruri = r.ruri) < ?1, 1)"
               " AND coalesce((SELECT changed_at FROM presence_latest WHERE ruri = r.ruri) < ?1, 1)"
               " AND NOT EXISTS (SELECT 1 FROM sessions WHERE ruri = r.ruri AND last_used >= ?1)"
               // Those that stand for no robot (origin.h).
               " AND substr(ruri, 1, 10) <> 'cyberwave:'"
               " AND ruri > ?2 ORDER BY ruri LIMIT ?3");
  prepare.Into(next_entry_, "SELECT next_entry FROM entries WHERE id = 0");
  for (const std::string_view table : kKeptTables) {
    const std::string from = " FROM " + std::string(table) + " WHERE ruri = ?";
    prepare.Into(counts_.emplace_back(), "SELECT count(*)" + from);
  }
  for (const std::string_view table : kRobotTables) {
    const std::string from = " FROM " + std::string(table) + " WHERE ruri = ?";
    prepare.Into(removals_.emplace_back(), "DELETE" + from);
  }
  for (const HistoryTable& table : kHistoryTables) {
    std::string sql("DELETE FROM ");
    sql.append(table.name).append(" WHERE rowid IN (SELECT rowid FROM ").append(table.name);
    sql.append(" WHERE ruri = ? AND entry < ? LIMIT ?) RETURNING 1");
    prepare.Into(history_removals_.emplace_back(), sql);
  }
  return prepare.status();
}

template <typename Result, typename Work>
absl::StatusOr<Result> SqliteRobotRemoval::InTransaction(const Work& work) {
  absl::Status status = begin_->Run();
  if (!status.ok()) return status;
  absl::StatusOr<Result> result = work();
  status = result.status();
  if (status.ok()) status = commit_->Run();
  if (status.ok()) return result;
  database_.RollbackIfOpen();
  return status;
}

absl::StatusOr<std::optional<RobotHold>> SqliteRobotRemoval::HoldOf(std::string_view ruri) {
  Rows rows = hold_->Select(ruri);
  const absl::StatusOr<bool> found = rows.Next();
  if (!found.ok()) return found.status();
  if (!*found) return std::nullopt;
  return HoldIn(rows, 0);
}

absl::StatusOr<std::vector<TableCount>> SqliteRobotRemoval::Count(std::string_view ruri) {
  std::vector<TableCount> counts;
  for (std::size_t i = 0; i < kKeptTables.size(); ++i) {
    const absl::StatusOr<std::size_t> rows = CountOf(*counts_[i], ruri);
    if (!rows.ok()) return rows.status();
    if (*rows > 0) counts.push_back({kKeptTables[i], *rows});
  }
  return counts;
}

absl::StatusOr<std::vector<SilentRobot>> SqliteRobotRemoval::SilentSince(SystemTime until,
                                                                         const ProcessId& /*self*/,
                                                                         std::string_view after) {
  Rows rows = silent_->Select(UnixMs(until), after, static_cast<std::int64_t>(kSilentRobotsMax));
  std::vector<SilentRobot> robots;
  while (true) {
    const absl::StatusOr<bool> found = rows.Next();
    if (!found.ok()) return found.status();
    if (!*found) return robots;
    robots.push_back({std::string(rows.Bytes(0)), static_cast<Epoch>(rows.Int(1))});
  }
}

absl::StatusOr<std::optional<EntryBound>> SqliteRobotRemoval::Remove(std::string_view ruri,
                                                                     Epoch epoch) {
  using Bound = std::optional<EntryBound>;
  return InTransaction<Bound>([&]() -> absl::StatusOr<Bound> {
    const auto hold = HoldOf(ruri);
    if (!hold.ok()) return hold.status();
    if ((*hold ? (*hold)->epoch : 0) != epoch) return std::nullopt;
    return RemoveRows(ruri);
  });
}

absl::StatusOr<EntryBound> SqliteRobotRemoval::RemoveRows(std::string_view ruri) {
  for (const std::unique_ptr<Statement>& removal : removals_) {
    absl::Status removed = removal->Run(ruri);
    if (!removed.ok()) return removed;
  }
  Rows rows = next_entry_->Select();
  const absl::StatusOr<bool> found = rows.Next();
  if (!found.ok()) return found.status();
  return EntryBound{rows.Int(0)};
}

absl::StatusOr<std::size_t> SqliteRobotRemoval::RemoveHistories(std::string_view ruri,
                                                                EntryBound below) {
  return InTransaction<std::size_t>([&] { return RemoveSome(ruri, below); });
}

absl::StatusOr<std::size_t> SqliteRobotRemoval::RemoveSome(std::string_view ruri,
                                                           EntryBound below) {
  std::size_t removed = 0;
  for (const std::unique_ptr<Statement>& removal : history_removals_) {
    const absl::StatusOr<std::size_t> rows = CountReturned(removal->Select(
        ruri, static_cast<std::int64_t>(below), static_cast<std::int64_t>(kRemovedPerCallMax)));
    if (!rows.ok()) return rows.status();
    removed += *rows;
  }
  return removed;
}

}  // namespace uplink::storage::sqlite
