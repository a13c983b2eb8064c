#pragma once

#include <memory>
#include <vector>

#include "storage/robot_removal.h"
#include "storage/sqlite/database.h"
#include "storage/sqlite/file_lock.h"
#include "storage/sqlite/statement.h"

namespace uplink::storage::sqlite {

/// Robots that leave an SQLite file.
///
/// Errors:  as in RobotRemoval.
/// Thread:  as in RobotRemoval.
class SqliteRobotRemoval final : public RobotRemoval {
 public:
  /// `database` is one of OpenBeside, and must outlive this.
  [[nodiscard]] static absl::StatusOr<std::unique_ptr<SqliteRobotRemoval>> Make(Database& database);
  SqliteRobotRemoval(const SqliteRobotRemoval&) = delete;
  SqliteRobotRemoval& operator=(const SqliteRobotRemoval&) = delete;

  [[nodiscard]] absl::StatusOr<std::optional<RobotHold>> HoldOf(std::string_view ruri) override;
  [[nodiscard]] absl::StatusOr<std::vector<TableCount>> Count(std::string_view ruri) override;
  [[nodiscard]] absl::StatusOr<std::vector<SilentRobot>> SilentSince(
      SystemTime until, const ProcessId& self, std::string_view after) override;
  [[nodiscard]] absl::StatusOr<std::optional<EntryBound>> Remove(std::string_view ruri,
                                                                 Epoch epoch) override;
  [[nodiscard]] absl::StatusOr<std::size_t> RemoveHistories(std::string_view ruri,
                                                            EntryBound below) override;

 private:
  explicit SqliteRobotRemoval(Database& database) : database_(database) {}
  absl::Status Prepare();
  absl::StatusOr<EntryBound> RemoveRows(std::string_view ruri);
  absl::StatusOr<std::size_t> RemoveSome(std::string_view ruri, EntryBound below);
  /// Runs `work` in a transaction of its own; all or nothing.
  template <typename Result, typename Work>
  absl::StatusOr<Result> InTransaction(const Work& work);

  using Statements = std::vector<std::unique_ptr<Statement>>;
  Database& database_;
  std::unique_ptr<Statement> begin_, commit_;
  std::unique_ptr<Statement> hold_, silent_, next_entry_;
  Statements counts_, removals_, history_removals_;
};

}  // namespace uplink::storage::sqlite
