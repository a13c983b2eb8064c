#pragma once

#include <memory>

#include "storage/forget_requests.h"
#include "storage/sqlite/database.h"
#include "storage/sqlite/statement.h"

namespace uplink::storage::sqlite {

/// What operators and the server that has an SQLite file say to each other of robots that are to be
/// forgotten, by the time of the machine.
///
/// Errors:  as in ForgetRequests.
/// Thread:  as in ForgetRequests.
class SqliteForgetRequests final : public ForgetRequests {
 public:
  /// `database` is one of OpenBeside, and must outlive this.
  [[nodiscard]] static absl::StatusOr<std::unique_ptr<SqliteForgetRequests>> Make(
      Database& database);
  SqliteForgetRequests(const SqliteForgetRequests&) = delete;
  SqliteForgetRequests& operator=(const SqliteForgetRequests&) = delete;

  [[nodiscard]] absl::StatusOr<std::uint64_t> Ask(std::string_view ruri, bool end_stream) override;
  [[nodiscard]] absl::StatusOr<AnsweredForget> AnswerTo(std::uint64_t number) override;
  [[nodiscard]] absl::Status Finish(std::uint64_t number, bool removed) override;
  [[nodiscard]] absl::StatusOr<std::vector<PendingForget>> Pending() override;
  [[nodiscard]] absl::Status Answer(std::uint64_t number, const AnsweredForget& answer) override;

 private:
  SqliteForgetRequests() = default;
  absl::Status Prepare(Database& database);

  std::unique_ptr<Statement> drop_old_, ask_, answer_to_, finish_, pending_, answer_;
};

}  // namespace uplink::storage::sqlite
