#pragma once

#include <memory>
#include <string>
#include <vector>

#include "storage/robot_removal.h"
#include "storage/sqlite/database.h"
#include "storage/sqlite/statement.h"

namespace uplink::storage::sqlite {

/// Robots that leave an SQLite file, and what its server is asked about it. Short writes beside the
/// store's writer, which take no lock but SQLite's own.
///
/// Errors:  of Open, kFailedPrecondition, naming the path: no file, not ours, not this program's
///          schema version. Of the calls, as in RobotRemoval.
/// Thread:  as in RobotRemoval.
class SqliteRobotRemoval final : public RobotRemoval {
 public:
  /// How long a call waits for another writer of the file.
  static constexpr milliseconds kBusyTimeout{5'000};

  /// The file must be there and migrated; nothing is created.
  [[nodiscard]] static absl::StatusOr<std::unique_ptr<SqliteRobotRemoval>> Open(
      const std::string& path);
  SqliteRobotRemoval(const SqliteRobotRemoval&) = delete;
  SqliteRobotRemoval& operator=(const SqliteRobotRemoval&) = delete;

  [[nodiscard]] absl::StatusOr<std::optional<RobotHold>> HoldOf(std::string_view ruri) override;
  [[nodiscard]] absl::StatusOr<std::vector<TableCount>> Count(std::string_view ruri) override;
  [[nodiscard]] absl::StatusOr<std::vector<SilentRobot>> SilentSince(
      SystemTime until, const ProcessId& self, std::string_view after) override;
  [[nodiscard]] absl::StatusOr<bool> Remove(std::string_view ruri, Epoch epoch) override;
  [[nodiscard]] absl::StatusOr<std::size_t> RemoveHistories(std::string_view ruri) override;
  [[nodiscard]] absl::StatusOr<std::uint64_t> Ask(std::string_view ruri, bool end_stream) override;
  [[nodiscard]] absl::StatusOr<AnsweredForget> AnswerTo(std::uint64_t number) override;
  [[nodiscard]] absl::Status Finish(std::uint64_t number) override;
  [[nodiscard]] absl::StatusOr<std::vector<PendingForget>> Pending() override;
  [[nodiscard]] absl::Status Answer(std::uint64_t number, const AnsweredForget& answer) override;

 private:
  explicit SqliteRobotRemoval(std::unique_ptr<Database> database)
      : database_(std::move(database)) {}
  absl::Status Prepare();
  absl::Status RemoveRows(std::string_view ruri);
  absl::StatusOr<std::size_t> RemoveSome(std::string_view ruri);
  /// Runs `work` in a transaction of its own; all or nothing.
  template <typename Result, typename Work>
  absl::StatusOr<Result> InTransaction(const Work& work);

  using Statements = std::vector<std::unique_ptr<Statement>>;
  std::unique_ptr<Database> database_;
  std::unique_ptr<Statement> begin_, commit_;
  std::unique_ptr<Statement> hold_, silent_, next_entry_;
  std::unique_ptr<Statement> drop_old_, ask_, answer_to_, finish_, pending_, answer_;
  Statements counts_, removals_, history_removals_;
  /// Entries of the robot that was removed last are below it.
  std::int64_t first_entry_after_ = 0;
};

}  // namespace uplink::storage::sqlite
