#pragma once

#include <functional>
#include <string_view>
#include <vector>

#include <absl/status/status.h>

#include "storage/postgres/link/connection.h"

// Transactions of the writer, whatever the server's defaults are.
namespace uplink::storage::postgres {

inline constexpr std::string_view kBegin = "BEGIN ISOLATION LEVEL READ COMMITTED READ WRITE";
/// Draws the transaction's number, once its robots are locked.
inline constexpr std::string_view kNextBatch = "SELECT nextval('uplinkd.batches')";

[[nodiscard]] absl::Status Begin(Connection& connection, std::string_view doing);

/// Runs the calls and COMMIT in one go: OK says that the transaction is durable. `before_commit`,
/// if set, is asked first; what is not OK rolls back instead and is the answer.
[[nodiscard]] absl::StatusOr<std::vector<Result>> RunAndCommitFor(
    Connection& connection, std::vector<StoreCall> calls, std::string_view doing,
    const std::function<absl::Status()>& before_commit);
[[nodiscard]] inline absl::Status RunAndCommit(Connection& connection, std::vector<StoreCall> calls,
                                               std::string_view doing,
                                               const std::function<absl::Status()>& before_commit) {
  return RunAndCommitFor(connection, std::move(calls), doing, before_commit).status();
}

/// An error of rows that decide: the refusal of one is no refusal of a record.
[[nodiscard]] absl::Status Decisive(const absl::Status& status);

}  // namespace uplink::storage::postgres
