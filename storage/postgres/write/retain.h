#pragma once

#include <absl/status/statusor.h>

#include "schema/base/clock.h"
#include "storage/postgres/link/connection.h"
#include "storage/retention.h"
#include "storage/store_rules.h"

namespace uplink::storage::postgres {

/// The part of Store::Retain for quarantine. A day that goes may have millions of rows, and each
/// may belong to a Reject that must stay. So each call empties a slice of kRetainRowsMax rows, and
/// the day is dropped once it is empty.
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

/// Days before and after today that have partitions: clocks jump, and a server may be away for a
/// while.
inline constexpr int kPartitionDaysBefore = 1;
inline constexpr int kPartitionDaysAfter = 3;
/// Days after its own today up to which the database makes partitions
/// (migrations/postgres/0001_schema.sql).
inline constexpr int kPartitionDaysAheadMax = 31;
static_assert(kPartitionDaysAfter + 1 < kPartitionDaysAheadMax, "clocks may differ by a day");

/// Store::Retain, in transactions of their own: partitions ahead; whole days that are too old are
/// dropped, those of quarantine by `days`; their rows in default partitions, closed runs and gaps
/// are deleted.
///
/// Until our clock is vouched for, nothing is deleted, and the partitions are those of the
/// database's own days: by ours they might lie years ahead.
[[nodiscard]] absl::StatusOr<Erased> RetainRows(Connection& connection, SystemTime now,
                                                const StoreRules& rules, QuarantineDays& days);

}  // namespace uplink::storage::postgres
