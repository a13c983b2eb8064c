#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "storage/batch.h"
#include "storage/outcome.h"
#include "storage/postgres/link/connection.h"
#include "storage/postgres/write/decide_slice.h"

namespace uplink::storage::postgres {

/// Writes one batch in one transaction, by the first of three ways that can:
///
/// 1. At once, in one round trip. The batch is written as if nothing stood against it, and
///    begin_batch, which goes first, raises if anything does. It knows nothing of drones' samples.
/// 2. After a look: what the batch touches is locked and read, each record decided, the rest
/// written.
/// 3. In halves, where the database itself refuses a row: each half behind a savepoint, down to the
///    one record that it refuses, whose quarantine row takes its place.
///
/// Made for one batch; the batch must outlive it. Thread: confined to that of its connection.
class BatchCommit final {
 public:
  /// `before_commit`, if set, is asked before each COMMIT is sent; what is not OK rolls back and is
  /// the answer. For tests.
  BatchCommit(Connection& connection, const Batch& batch, const CommitTerms& terms,
              const std::function<absl::Status()>& before_commit)
      : connection_(connection), batch_(batch), terms_(terms), before_commit_(before_commit) {}

  /// Errors: as Store::Commit. kAborted where transactions stood in each other's way.
  [[nodiscard]] absl::StatusOr<std::vector<Outcome>> Run();
  /// How many mission runs it closed for their bound, once Run was OK.
  [[nodiscard]] std::size_t runs_closed() const { return runs_closed_; }

 private:
  using Outcomes = std::vector<Outcome>;

  [[nodiscard]] Slice Whole() const { return {&batch_, 0, batch_.records.size(), true}; }
  /// False if the batch alone shows that it cannot be written at once.
  [[nodiscard]] bool MayWriteAtOnce() const;
  absl::StatusOr<Outcomes> WriteAtOnce();
  absl::StatusOr<Outcomes> WriteAfterLook();
  absl::StatusOr<Outcomes> WriteInHalves();
  /// Decides and writes a slice behind a savepoint; kInvalidArgument if the database refuses a row
  /// of it, and nothing of the slice is written then. `earlier`: of DecideSlice.
  absl::StatusOr<Outcomes> WriteSlice(const Slice& slice,
                                      const std::optional<DatabaseRefusal>& refusal,
                                      std::span<const Outcome> earlier);
  absl::Status CommitCalls(std::vector<StoreCall> calls);
  absl::Status Halve(const Slice& slice, Outcomes& outcomes);
  absl::Status Isolate(const Slice& slice, const absl::Status& cause, Outcomes& outcomes);
  absl::Status AbandonAfter(const absl::Status& error);

  Connection& connection_;
  const Batch& batch_;
  const CommitTerms terms_;
  const std::function<absl::Status()>& before_commit_;
  std::size_t runs_closed_ = 0;
};

}  // namespace uplink::storage::postgres
