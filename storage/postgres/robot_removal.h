#pragma once

#include <memory>

#include "storage/postgres/store.h"
#include "storage/robot_removal.h"

namespace uplink::storage::postgres {

/// Robots that leave a PostgreSQL database, and what servers are asked about it.
///
/// Errors:  as in RobotRemoval; kUnavailable while the server is away, and every call tries again.
/// Thread:  as in RobotRemoval.
class PostgresRobotRemoval final : public RobotRemoval {
 public:
  /// Does not connect. Of the options: the URL, the password, the timeouts. `clock` must outlive
  /// this.
  ///
  /// Errors: kInvalidArgument for the URL.
  [[nodiscard]] static absl::StatusOr<std::unique_ptr<PostgresRobotRemoval>> Make(
      const StoreOptions& options, const Clock& clock);
  ~PostgresRobotRemoval() override;
  PostgresRobotRemoval(const PostgresRobotRemoval&) = delete;
  PostgresRobotRemoval& operator=(const PostgresRobotRemoval&) = delete;

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
  struct Impl;
  explicit PostgresRobotRemoval(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace uplink::storage::postgres
