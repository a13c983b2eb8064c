#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "schema/base/clock.h"

// What an operator does to a PostgreSQL store from outside the server.
namespace uplink::storage::postgres {

/// How to reach it, as in StoreOptions; the role that migrates owns the schema.
struct AdminOptions {
  std::string url;
  std::string password_file;
  /// To one place of the URL.
  milliseconds connect_timeout{5'000};
  /// What one call may take: a step may have to build an index over a large table.
  milliseconds call_timeout = std::chrono::minutes(30);
};

struct StoreState {
  /// `host:port/database`.
  std::string where;
  /// Of the server: `15.4` is 150004.
  std::int64_t server_version = 0;
  /// Of the schema; 0 if there is none.
  std::int64_t schema_version = 0;
  /// Of this program.
  std::int64_t schema_needed = 0;
  /// Why this program may not use the schema, if so.
  absl::Status schema_fits;
  std::size_t steps_missing = 0;
  bool fsync = true;
  bool full_page_writes = true;
  /// Of a session of this role.
  std::string synchronous_commit;
  /// Tables of the schema in which the role may not do what the server does.
  std::size_t tables_denied = 0;
  bool utf8 = true;
  bool read_only = false;
  bool standby = false;
  milliseconds clock_offset{0};
  /// ReadDataFolder's.
  std::string data_folder;
};

/// Errors: of the connection.
[[nodiscard]] absl::StatusOr<StoreState> ReadState(const AdminOptions& options, const Clock& clock);

/// Applies the steps that are missing, and grants the schema to `grant_to` if that is not empty.
/// Returns the names of the steps.
[[nodiscard]] absl::StatusOr<std::vector<std::string>> MigrateStore(const AdminOptions& options,
                                                                    const std::string& grant_to,
                                                                    const Clock& clock);

}  // namespace uplink::storage::postgres
