#include "storage/postgres/write/transaction.h"

#include <string>
#include <utility>

#include <absl/strings/cord.h>

namespace uplink::storage::postgres {
namespace {

/// The payload of such an error; it is empty.
constexpr std::string_view kInDoubt = "uplinkd/commit_in_doubt";

absl::Status InDoubt(const Connection& connection, std::string_view doing,
                     const std::string& warning) {
  absl::Status status =
      absl::UnavailableError("postgresql " + connection.where() + ": " + std::string(doing) +
                             ": whether the commit is durable is unknown: " + warning);
  status.SetPayload({kInDoubt.data(), kInDoubt.size()}, absl::Cord());
  return status;
}

}  // namespace

std::vector<StoreCall> BeginCalls() {
  std::vector<StoreCall> calls;
  calls.push_back({kBegin, {}});
  calls.push_back({kSetLocal, {}});
  return calls;
}

absl::Status Begin(Connection& connection, std::string_view doing) {
  return connection.Run(BeginCalls(), doing).status();
}

absl::StatusOr<std::vector<Result>> RunAndCommitFor(
    Connection& connection, std::vector<StoreCall> calls, std::string_view doing,
    const std::function<absl::Status()>& before_commit) {
  const absl::Status allowed = before_commit ? before_commit() : absl::OkStatus();
  calls.push_back({allowed.ok() ? "COMMIT" : "ROLLBACK", {}});
  absl::StatusOr<std::vector<Result>> results = connection.Run(calls, doing);
  if (!allowed.ok()) return allowed;
  if (results.ok() && results->back().tag() != "COMMIT") {
    return absl::AbortedError("postgresql " + connection.where() +
                              ": the transaction was rolled back instead of committed");
  }
  if (const auto warning = results.ok() ? connection.last_answers_warning() : std::nullopt) {
    return InDoubt(connection, doing, *warning);
  }
  return results;
}

absl::StatusOr<Result> RunAlone(Connection& connection, StoreCall call, std::string_view doing) {
  std::vector<StoreCall> calls;
  calls.push_back({kBegin, {}});
  calls.push_back(std::move(call));
  auto results = RunAndCommitFor(connection, std::move(calls), doing, nullptr);
  if (!results.ok()) return Decisive(results.status());
  return std::move((*results)[1]);
}

bool IsInDoubt(const absl::Status& status) {
  return status.GetPayload({kInDoubt.data(), kInDoubt.size()}).has_value();
}

absl::Status Decisive(const absl::Status& status) {
  if (!absl::IsInvalidArgument(status)) return status;
  return absl::InternalError("a deciding row is refused: " + std::string(status.message()));
}

}  // namespace uplink::storage::postgres
