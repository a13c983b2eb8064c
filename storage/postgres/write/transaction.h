#pragma once

#include <functional>
#include <string_view>
#include <vector>

#include <absl/status/status.h>

#include "storage/postgres/link/connection.h"

// Transactions of the writer, whatever the server's defaults are.
namespace uplink::storage::postgres {

inline constexpr std::string_view kBegin = "BEGIN ISOLATION LEVEL READ COMMITTED READ WRITE";
/// What an ack rests on, for this transaction alone: a pooler that lends sessions per transaction
/// throws away what a session was set to, and a server that is told to keep its warnings to itself
/// would hide that a commit was not replicated.
inline constexpr std::string_view kSetLocal =
    "SELECT set_config('synchronous_commit', 'on', true),"
    " set_config('client_min_messages', 'warning', true)";
/// Makes the commit wait for a synchronous standby even if the transaction changes no row: what it
/// found written may not be on the standby yet. Written to the log alone; no table grows.
inline constexpr std::string_view kLogPosition =
    "SELECT pg_logical_emit_message(true, 'uplinkd', '')";
/// Draws the transaction's number, once its robots are locked.
inline constexpr std::string_view kNextBatch = "SELECT nextval('uplinkd.batches')";

/// What a transaction begins with that acks or opens.
[[nodiscard]] std::vector<StoreCall> BeginCalls();
[[nodiscard]] absl::Status Begin(Connection& connection, std::string_view doing);

/// Runs the calls and COMMIT in one go: OK says that the transaction is durable. `before_commit`,
/// if set, is asked first; what is not OK rolls back instead and is the answer.
///
/// Errors: those of Connection::Run; kUnavailable where the server warned with the commit (the wait
///         for a synchronous standby was cancelled): whether it is durable is unknown, and
///         IsInDoubt says so.
[[nodiscard]] absl::StatusOr<std::vector<Result>> RunAndCommitFor(
    Connection& connection, std::vector<StoreCall> calls, std::string_view doing,
    const std::function<absl::Status()>& before_commit);
[[nodiscard]] inline absl::Status RunAndCommit(Connection& connection, std::vector<StoreCall> calls,
                                               std::string_view doing,
                                               const std::function<absl::Status()>& before_commit) {
  return RunAndCommitFor(connection, std::move(calls), doing, before_commit).status();
}

/// One statement as a transaction of its own that no ack rests on; its answer.
[[nodiscard]] absl::StatusOr<Result> RunAlone(Connection& connection, StoreCall call,
                                              std::string_view doing);

/// The error is that of a commit which the server answered with a warning.
[[nodiscard]] bool IsInDoubt(const absl::Status& status);

/// An error of rows that decide: if the database refuses one, that refuses no record.
[[nodiscard]] absl::Status Decisive(const absl::Status& status);

}  // namespace uplink::storage::postgres
