#include "storage/forget_store.h"

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "storage/access_rules.h"
#include "storage/kept_tables.h"
#include "storage/read_row.h"
#include "storage/sqlite/access_sql.h"
#include "storage/sqlite/connections.h"
#include "storage/sqlite/parts.h"

namespace uplink::storage::sqlite {
namespace {

/// The machine's time: the program that asks runs beside the server.
constexpr std::string_view kNow = "CAST(strftime('%s', 'now') AS INTEGER)";

std::int64_t SecondsOf(std::chrono::seconds time) { return time.count(); }

std::string WithNow(std::string_view before, std::string_view after) {
  return std::string(before).append(kNow).append(after);
}

class SqliteForgetRequests final : public ForgetRequests {
 public:
  [[nodiscard]] absl::Status Prepare(Database& database) {
    Preparer prepare(database);
    prepare.Into(drop_old_, WithNow("DELETE FROM forget_requests WHERE touched_s < ", " - ?"));
    prepare.Into(ask_,
                 WithNow("INSERT INTO forget_requests (ruri, end_stream, touched_s) VALUES (?, ?, ",
                         ") RETURNING number"));
    prepare.Into(answer_to_, "SELECT answer, epoch FROM forget_requests WHERE number = ?");
    prepare.Into(finish_, WithNow("UPDATE forget_requests SET finished = 1, touched_s = ",
                                  ", answer = iif(?2, ?3, answer) WHERE number = ?1"));
    prepare.Into(
        pending_,
        WithNow("SELECT f.number, f.ruri, f.end_stream, f.finished, r.owner, r.epoch, f.answer"
                " FROM forget_requests AS f LEFT JOIN robots AS r ON r.ruri = f.ruri"
                " WHERE f.touched_s > ",
                " - iif(f.finished, ?1, ?2) AND (f.finished OR f.answer = 0)"
                " ORDER BY f.number DESC LIMIT ?3"));
    prepare.Into(answer_,
                 "UPDATE forget_requests SET answer = ?2, epoch = ?3"
                 " WHERE number = ?1 AND answer = 0 AND NOT finished");
    return prepare.status();
  }

  absl::StatusOr<std::uint64_t> Ask(std::string_view ruri, bool end_stream) override {
    absl::Status dropped = drop_old_->Run(SecondsOf(kForgottenTold));
    if (!dropped.ok()) return dropped;
    // To the end: that is what commits it.
    const auto numbers = ask_->Select(ruri, std::int64_t{end_stream}).All([](const Rows& row) {
      return NumberIn(row, 0);
    });
    if (!numbers.ok()) return numbers.status();
    return numbers->back();
  }
  absl::StatusOr<AnsweredForget> AnswerTo(std::uint64_t number) override {
    const auto answer = answer_to_->Select(number).First(AnswerIn<Rows>);
    if (!answer.ok()) return answer.status();
    return answer->value_or(AnsweredForget());
  }
  absl::Status Finish(std::uint64_t number, bool removed) override {
    return finish_->Run(number, std::int64_t{removed}, kForgetRemoved);
  }
  absl::StatusOr<std::vector<PendingForget>> Pending() override {
    return pending_
        ->Select(SecondsOf(kForgottenTold), SecondsOf(kForgetRequestLives), kForgetRequestsMax)
        .All(PendingIn<Rows>);
  }
  absl::Status Answer(std::uint64_t number, const AnsweredForget& answer) override {
    return answer_->Run(number, static_cast<std::int64_t>(answer.answer), answer.epoch);
  }

 private:
  std::unique_ptr<Statement> drop_old_, ask_, answer_to_, finish_, pending_, answer_;
};

class SqliteRobotRemoval final : public RobotRemoval {
 public:
  /// It must outlive this.
  explicit SqliteRobotRemoval(Database& database) : database_(database) {}

  [[nodiscard]] absl::Status Prepare() {
    Preparer prepare(database_);
    prepare.Into(hold_, "SELECT owner, epoch FROM robots WHERE ruri = ?");
    // The store is one process's at a time: no other can have a stream. Those that stand for no
    // robot (origin.h) are left out.
    prepare.Into(
        silent_,
        "SELECT ruri, epoch FROM robots AS r WHERE last_seen < ?1"
        " AND coalesce((SELECT last_sign_at FROM live WHERE ruri = r.ruri) < ?1, 1)"
        " AND coalesce((SELECT changed_at FROM presence_latest WHERE ruri = r.ruri) < ?1, 1)"
        " AND NOT EXISTS (SELECT 1 FROM sessions WHERE ruri = r.ruri AND last_used >= ?1)"
        " AND coalesce((SELECT last_used FROM drone_claims WHERE ruri = r.ruri) < ?1, 1)"
        " AND substr(ruri, 1, 10) <> 'cyberwave:'"
        " AND ruri > ?2 ORDER BY ruri LIMIT ?3");
    prepare.Into(next_version_, kNextVersionSql);
    prepare.Into(is_noted_, std::string("SELECT count(*) FROM robot_settings WHERE ruri = ? AND ")
                                .append(kHasNotesSql));
    prepare.Into(drop_notes_, WithNow(std::string("UPDATE robot_settings SET ")
                                          .append(kNoNotesSql)
                                          .append(", changed_at = 1000 * "),
                                      ", version = ?2 WHERE ruri = ?1"));
    prepare.Into(next_entry_, "SELECT next_entry FROM entries WHERE id = 0");
    const auto of_robot = [](std::string_view doing, std::string_view table) {
      return std::string(doing).append(" FROM ").append(table).append(" WHERE ruri = ?");
    };
    for (const std::string_view table : kKeptTables) {
      prepare.Into(counts_.emplace_back(), of_robot("SELECT count(*)", table));
    }
    for (const std::string_view table : kRobotTables) {
      prepare.Into(removals_.emplace_back(), of_robot("DELETE", table));
    }
    for (const HistoryTable& table : kHistoryTables) {
      prepare.Into(history_removals_.emplace_back(),
                   std::string("DELETE FROM ").append(table.name) + " WHERE rowid IN (" +
                       of_robot("SELECT rowid", table.name) +
                       " AND entry < ? LIMIT ?) RETURNING 1");
    }
    return prepare.status();
  }

  absl::StatusOr<std::optional<RobotHold>> HoldOf(std::string_view ruri) override {
    const auto hold = hold_->Select(ruri).First([](const Rows& row) { return HoldIn(row, 0); });
    if (!hold.ok()) return hold.status();
    return hold->value_or(std::nullopt);
  }
  absl::StatusOr<std::vector<TableCount>> Count(std::string_view ruri) override {
    std::vector<TableCount> counts;
    for (std::size_t i = 0; i < kKeptTables.size(); ++i) {
      const absl::StatusOr<std::int64_t> rows = counts_[i]->Select(ruri).OnlyInt();
      if (!rows.ok()) return rows.status();
      if (*rows > 0) counts.push_back({kKeptTables[i], static_cast<std::uint64_t>(*rows)});
    }
    return counts;
  }
  absl::StatusOr<std::vector<SilentRobot>> SilentSince(SystemTime until, const ProcessId& /*self*/,
                                                       std::string_view after) override {
    return silent_->Select(until, after, kSilentRobotsMax).All([](const Rows& row) {
      return SilentRobot{TextIn(row, 0), NumberIn(row, 1)};
    });
  }
  absl::StatusOr<std::optional<EntryBound>> Remove(std::string_view ruri, Epoch epoch) override {
    using Bound = std::optional<EntryBound>;
    return database_.InTransaction([&]() -> absl::StatusOr<Bound> {
      const auto hold = HoldOf(ruri);
      if (!hold.ok()) return hold.status();
      if ((*hold ? (*hold)->epoch : 0) != epoch) return std::nullopt;
      for (const std::unique_ptr<Statement>& removal : removals_) {
        absl::Status removed = removal->Run(ruri);
        if (!removed.ok()) return removed;
      }
      absl::Status dropped = DropNotes(ruri);
      if (!dropped.ok()) return dropped;
      const absl::StatusOr<std::int64_t> next_entry = next_entry_->Select().OnlyInt();
      if (!next_entry.ok()) return next_entry.status();
      return EntryBound{*next_entry};
    });
  }
  absl::StatusOr<std::size_t> RemoveHistories(std::string_view ruri, EntryBound below) override {
    return database_.InTransaction([&]() -> absl::StatusOr<std::size_t> {
      std::size_t removed = 0;
      for (const std::unique_ptr<Statement>& removal : history_removals_) {
        const absl::StatusOr<std::size_t> rows =
            removal->Select(ruri, static_cast<std::int64_t>(below), kRemovedPerCallMax).Count();
        if (!rows.ok()) return rows.status();
        removed += *rows;
      }
      return removed;
    });
  }

 private:
  using Statements = std::vector<std::unique_ptr<Statement>>;

  /// Labels and note go with the robot. A block and a registration stay: they are of its name.
  absl::Status DropNotes(std::string_view ruri) {
    const absl::StatusOr<std::int64_t> noted = is_noted_->Select(ruri).OnlyInt();
    if (!noted.ok() || *noted == 0) return noted.status();
    const absl::StatusOr<std::int64_t> version = next_version_->Select().OnlyInt();
    if (!version.ok()) return version.status();
    return drop_notes_->Run(ruri, *version);
  }

  Database& database_;
  std::unique_ptr<Statement> hold_, silent_, next_entry_, next_version_, is_noted_, drop_notes_;
  Statements counts_, removals_, history_removals_;
};

class SqliteForgetStore final : public ForgetStore {
 public:
  explicit SqliteForgetStore(SideConnection side)
      : side_(std::move(side)), removal_(*side_.database) {}

  [[nodiscard]] absl::Status Prepare() {
    absl::Status status = removal_.Prepare();
    return status.ok() ? requests_.Prepare(*side_.database) : status;
  }
  RobotRemoval& removal() override { return removal_; }
  ForgetRequests& requests() override { return requests_; }

 private:
  SideConnection side_;
  SqliteRobotRemoval removal_;
  SqliteForgetRequests requests_;
};

}  // namespace

absl::StatusOr<std::unique_ptr<ForgetStore>> OpenForgetStore(const std::string& path,
                                                             DamagePtr damage) {
  return MakeOnSideConnection<SqliteForgetStore>(path, std::move(damage));
}

}  // namespace uplink::storage::sqlite
