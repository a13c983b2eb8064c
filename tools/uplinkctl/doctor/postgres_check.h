#pragma once

#include <chrono>

#include <absl/status/statusor.h>

#include "schema/base/clock.h"
#include "server/config/config.h"
#include "storage/postgres/admin.h"
#include "tools/uplinkctl/doctor/finding.h"

namespace uplink::ctl {

/// How long a database may take to answer: to each connect to one place of the URL, and to each
/// call. Looking up a host's name takes what the system's resolver allows.
inline constexpr milliseconds kDatabaseConnectMax = std::chrono::seconds(3);
inline constexpr milliseconds kDatabaseCallMax = std::chrono::seconds(5);
/// How far apart the database's clock and ours may be: as the server's log counts it
/// (store_clock_differs).
inline constexpr milliseconds kDatabaseClockApartMax = std::chrono::seconds(5);

/// Whether a server could use the database: reachable, schema, rights, durability, clock. A pure
/// function.
[[nodiscard]] Findings PostgresFindings(const absl::StatusOr<storage::postgres::StoreState>& state,
                                        const config::StoreConfig& store);

}  // namespace uplink::ctl
