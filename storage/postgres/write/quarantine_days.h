#pragma once

#include <absl/status/statusor.h>

#include "schema/base/clock.h"
#include "storage/postgres/link/connection.h"
#include "storage/retention.h"

namespace uplink::storage::postgres {

/// The part of Store::Retain for quarantine. A day that goes may have millions of rows, and each
/// may be of a Reject that is to be kept: so a day is emptied by slices of kRetainRowsMax rows, one
/// per call, and dropped once it is empty.
///
/// Thread: confined to the thread of its connection.
class QuarantineDays final {
 public:
  /// Deletes the oldest rows that arrived before `until`, kRetainRowsMax in all, and drops the days
  /// that are empty by then, about ten. Each statement is a transaction of its own.
  ///
  /// Errors: those of the connection.
  [[nodiscard]] absl::StatusOr<Erased> Erase(Connection& connection, SystemTime until);

 private:
  absl::Status EmptyDays(Connection& connection, SystemTime until, Erased& erased);

  /// Arrival of the first row of the last slice: nothing is looked for before it, where dead rows
  /// lie. The slice before stays in the look, which marks its entries of the index as dead.
  SystemTime since_;
};

}  // namespace uplink::storage::postgres
