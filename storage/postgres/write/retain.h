#pragma once

#include <cstddef>

#include <absl/status/statusor.h>

#include "schema/base/clock.h"
#include "storage/postgres/link/connection.h"
#include "storage/types.h"

namespace uplink::storage::postgres {

/// Days before and after today of which the partitions are there: clocks jump, and a server may be
/// away for a while.
inline constexpr int kPartitionDaysBefore = 1;
inline constexpr int kPartitionDaysAfter = 3;

/// Store::Retain, in transactions of their own: partitions ahead; whole days that are too old are
/// dropped; their rows in default partitions, closed runs and gaps are deleted. Returns partitions
/// plus rows.
///
/// Errors: kFailedPrecondition while `now` is further from the server's clock than
///         `clock_offset_max`; partitions are made all the same.
[[nodiscard]] absl::StatusOr<std::size_t> RetainRows(Connection& connection, SystemTime now,
                                                     const StoreRules& rules,
                                                     milliseconds clock_offset_max);

}  // namespace uplink::storage::postgres
