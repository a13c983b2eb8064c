#pragma once

#include "storage/forget_requests.h"

namespace uplink::storage::postgres {

class OwnConnection;

/// What operators and servers that share a PostgreSQL database say to each other of robots that are
/// to be forgotten, by the time of the database.
///
/// Errors:  as in ForgetRequests; kUnavailable while the server is away, and every call tries
/// again. Thread:  as in ForgetRequests.
class PostgresForgetRequests final : public ForgetRequests {
 public:
  /// `connection` must outlive this.
  explicit PostgresForgetRequests(OwnConnection& connection) : connection_(connection) {}
  PostgresForgetRequests(const PostgresForgetRequests&) = delete;
  PostgresForgetRequests& operator=(const PostgresForgetRequests&) = delete;

  [[nodiscard]] absl::StatusOr<std::uint64_t> Ask(std::string_view ruri, bool end_stream) override;
  [[nodiscard]] absl::StatusOr<AnsweredForget> AnswerTo(std::uint64_t number) override;
  [[nodiscard]] absl::Status Finish(std::uint64_t number, bool removed) override;
  [[nodiscard]] absl::StatusOr<std::vector<PendingForget>> Pending() override;
  [[nodiscard]] absl::Status Answer(std::uint64_t number, const AnsweredForget& answer) override;

 private:
  OwnConnection& connection_;
};

}  // namespace uplink::storage::postgres
