#include "storage/sqlite/robot_removal.h"

#include <algorithm>
#include <utility>

#include "storage/kept_tables.h"
#include "storage/sqlite/counts.h"
#include "storage/sqlite/migrations.h"
#include "storage/sqlite/prepare.h"
#include "storage/sqlite/schema.h"

namespace uplink::storage::sqlite {
namespace {

/// The machine's time: whoever asks runs beside the server.
constexpr std::string_view kNow = "CAST(strftime('%s', 'now') AS INTEGER)";
constexpr auto kSecondsTold =
    std::chrono::duration_cast<std::chrono::seconds>(kForgottenTold).count();
constexpr auto kSecondsAsked =
    std::chrono::duration_cast<std::chrono::seconds>(kForgetRequestLives).count();

std::string WithNow(std::string_view before, std::string_view after) {
  return std::string(before).append(kNow).append(after);
}

std::optional<RobotHold> HoldIn(const Rows& rows, int column) {
  if (rows.Null(column)) return std::nullopt;
  RobotHold hold{.owner = {}, .epoch = static_cast<Epoch>(rows.Int(column + 1))};
  const std::string_view owner = rows.Bytes(column);
  std::copy_n(owner.begin(), std::min(owner.size(), hold.owner.size()), hold.owner.begin());
  return hold;
}

}  // namespace

absl::StatusOr<std::unique_ptr<SqliteRobotRemoval>> SqliteRobotRemoval::Open(
    const std::string& path) {
  // A look that makes no file comes first.
  auto there = Database::Open(path, Access::kRead, kBusyTimeout);
  if (!there.ok()) return there.status();
  auto database = Database::Open(path, Access::kWrite, kBusyTimeout);
  if (!database.ok()) return database.status();
  absl::Status status = CheckFile(**database, Migrations());
  if (status.ok()) status = Migrate(**database, Migrations(), IfOlder::kRefuse);
  if (status.ok()) status = ConfigureWriter(**database);
  if (!status.ok()) return status;
  std::unique_ptr<SqliteRobotRemoval> removal(new SqliteRobotRemoval(*std::move(database)));
  status = removal->Prepare();
  if (!status.ok()) return status;
  return removal;
}

absl::Status SqliteRobotRemoval::Prepare() {
  Preparer prepare(*database_);
  prepare.Into(begin_, "BEGIN IMMEDIATE");
  prepare.Into(commit_, "COMMIT");
  prepare.Into(hold_, "SELECT owner, epoch FROM robots WHERE ruri = ?");
  // The store is one process's at a time: no other can have a stream.
  prepare.Into(silent_,
               "SELECT ruri, epoch FROM robots AS r WHERE last_seen_ms < ?1"
               " AND coalesce((SELECT last_sign_ms FROM live WHERE ruri = r.ruri) < ?1, 1)"
               " AND coalesce((SELECT at_ms FROM presence_latest WHERE ruri = r.ruri) < ?1, 1)"
               " AND NOT EXISTS (SELECT 1 FROM sessions WHERE ruri = r.ruri AND last_used_ms >= ?1)"
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
    const std::string name(table.name);
    prepare.Into(history_removals_.emplace_back(),
                 "DELETE FROM " + name + " WHERE rowid IN (SELECT rowid FROM " + name +
                     " WHERE ruri = ? AND entry < ? LIMIT ?) RETURNING 1");
  }
  prepare.Into(drop_old_, WithNow("DELETE FROM forget_requests WHERE touched_s < ", " - ?"));
  prepare.Into(ask_,
               WithNow("INSERT INTO forget_requests (ruri, end_stream, touched_s) VALUES (?, ?, ",
                       ") RETURNING number"));
  prepare.Into(answer_to_, "SELECT answer, epoch FROM forget_requests WHERE number = ?");
  prepare.Into(finish_, WithNow("UPDATE forget_requests SET finished = 1, touched_s = ",
                                " WHERE number = ?"));
  prepare.Into(pending_,
               WithNow("SELECT f.number, f.ruri, f.end_stream, f.finished, r.owner, r.epoch"
                       " FROM forget_requests AS f LEFT JOIN robots AS r ON r.ruri = f.ruri"
                       " WHERE f.touched_s > ",
                       " - iif(f.finished, ?1, ?2) AND (f.finished OR f.answer = 0)"
                       " ORDER BY f.number DESC LIMIT ?3"));
  prepare.Into(answer_,
               "UPDATE forget_requests SET answer = ?2, epoch = ?3"
               " WHERE number = ?1 AND answer = 0 AND NOT finished");
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
  database_->RollbackIfOpen();
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

absl::StatusOr<bool> SqliteRobotRemoval::Remove(std::string_view ruri, Epoch epoch) {
  return InTransaction<bool>([&]() -> absl::StatusOr<bool> {
    const auto hold = HoldOf(ruri);
    if (!hold.ok()) return hold.status();
    if ((*hold ? (*hold)->epoch : 0) != epoch) return false;
    absl::Status removed = RemoveRows(ruri);
    if (!removed.ok()) return removed;
    return true;
  });
}

absl::Status SqliteRobotRemoval::RemoveRows(std::string_view ruri) {
  for (const std::unique_ptr<Statement>& removal : removals_) {
    absl::Status removed = removal->Run(ruri);
    if (!removed.ok()) return removed;
  }
  Rows rows = next_entry_->Select();
  const absl::StatusOr<bool> found = rows.Next();
  if (!found.ok()) return found.status();
  first_entry_after_ = rows.Int(0);
  return absl::OkStatus();
}

absl::StatusOr<std::size_t> SqliteRobotRemoval::RemoveHistories(std::string_view ruri) {
  return InTransaction<std::size_t>([&] { return RemoveSome(ruri); });
}

absl::StatusOr<std::size_t> SqliteRobotRemoval::RemoveSome(std::string_view ruri) {
  std::size_t removed = 0;
  for (const std::unique_ptr<Statement>& removal : history_removals_) {
    const absl::StatusOr<std::size_t> rows = CountReturned(
        removal->Select(ruri, first_entry_after_, static_cast<std::int64_t>(kRemovedPerCallMax)));
    if (!rows.ok()) return rows.status();
    removed += *rows;
  }
  return removed;
}

absl::StatusOr<std::uint64_t> SqliteRobotRemoval::Ask(std::string_view ruri, bool end_stream) {
  absl::Status dropped = drop_old_->Run(std::int64_t{kSecondsTold});
  if (!dropped.ok()) return dropped;
  std::uint64_t number = 0;
  Rows rows = ask_->Select(ruri, std::int64_t{end_stream});
  // To the end: that is what commits it.
  while (true) {
    const absl::StatusOr<bool> found = rows.Next();
    if (!found.ok()) return found.status();
    if (!*found) return number;
    number = static_cast<std::uint64_t>(rows.Int(0));
  }
}

absl::StatusOr<AnsweredForget> SqliteRobotRemoval::AnswerTo(std::uint64_t number) {
  Rows rows = answer_to_->Select(number);
  const absl::StatusOr<bool> found = rows.Next();
  if (!found.ok()) return found.status();
  if (!*found) return AnsweredForget();
  return AnsweredForget{static_cast<ForgetAnswer>(rows.Int(0)), static_cast<Epoch>(rows.Int(1))};
}

absl::Status SqliteRobotRemoval::Finish(std::uint64_t number) { return finish_->Run(number); }

absl::StatusOr<std::vector<PendingForget>> SqliteRobotRemoval::Pending() {
  Rows rows = pending_->Select(std::int64_t{kSecondsTold}, std::int64_t{kSecondsAsked},
                               static_cast<std::int64_t>(kForgetRequestsMax));
  std::vector<PendingForget> pending;
  while (true) {
    const absl::StatusOr<bool> found = rows.Next();
    if (!found.ok()) return found.status();
    if (!*found) return pending;
    pending.push_back({.number = static_cast<std::uint64_t>(rows.Int(0)),
                       .ruri = std::string(rows.Bytes(1)),
                       .end_stream = rows.Int(2) != 0,
                       .finished = rows.Int(3) != 0,
                       .hold = HoldIn(rows, 4)});
  }
}

absl::Status SqliteRobotRemoval::Answer(std::uint64_t number, const AnsweredForget& answer) {
  return answer_->Run(number, static_cast<std::int64_t>(answer.answer), answer.epoch);
}

}  // namespace uplink::storage::sqlite
