#include "storage/postgres/write/transaction.h"

#include <string>
#include <utility>

namespace uplink::storage::postgres {

absl::Status Begin(Connection& connection, std::string_view doing) {
  std::vector<StoreCall> calls;
  calls.push_back({kBegin, {}});
  return connection.Run(calls, doing).status();
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
  return results;
}

absl::Status Decisive(const absl::Status& status) {
  if (!absl::IsInvalidArgument(status)) return status;
  return absl::InternalError("a deciding row is refused: " + std::string(status.message()));
}

}  // namespace uplink::storage::postgres
