#pragma once

#include <absl/status/statusor.h>

#include "schema/base/clock.h"
#include "storage/postgres/link/connection.h"
#include "storage/postgres/write/quarantine_days.h"
#include "storage/retention.h"
#include "storage/store_rules.h"

namespace uplink::storage::postgres {

/// Days before and after today of which the partitions are there: clocks jump, and a server may be
/// away for a while.
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
/// While nobody vouches for our clock nothing is deleted, and the partitions are those of the
/// database's own days: by ours they might lie years ahead.
[[nodiscard]] absl::StatusOr<Erased> RetainRows(Connection& connection, SystemTime now,
                                                const StoreRules& rules, QuarantineDays& days);

}  // namespace uplink::storage::postgres
