#pragma once

#include <memory>

#include "storage/robot_removal.h"

namespace uplink::storage::postgres {

class OwnConnection;

/// Robots that leave a PostgreSQL database.
///
/// Errors:  as in RobotRemoval; kUnavailable while the server is away, and every call tries again.
/// Thread:  as in RobotRemoval.
class PostgresRobotRemoval final : public RobotRemoval {
 public:
  /// `connection` must outlive this.
  explicit PostgresRobotRemoval(OwnConnection& connection);
  ~PostgresRobotRemoval() override;
  PostgresRobotRemoval(const PostgresRobotRemoval&) = delete;
  PostgresRobotRemoval& operator=(const PostgresRobotRemoval&) = delete;

  [[nodiscard]] absl::StatusOr<std::optional<RobotHold>> HoldOf(std::string_view ruri) override;
  [[nodiscard]] absl::StatusOr<std::vector<TableCount>> Count(std::string_view ruri) override;
  [[nodiscard]] absl::StatusOr<std::vector<SilentRobot>> SilentSince(
      SystemTime until, const ProcessId& self, std::string_view after) override;
  [[nodiscard]] absl::StatusOr<std::optional<EntryBound>> Remove(std::string_view ruri,
                                                                 Epoch epoch) override;
  [[nodiscard]] absl::StatusOr<std::size_t> RemoveHistories(std::string_view ruri,
                                                            EntryBound below) override;

 private:
  /// Made of kKeptTables.
  struct Statements;

  OwnConnection& connection_;
  const std::unique_ptr<const Statements> statements_;
};

}  // namespace uplink::storage::postgres
