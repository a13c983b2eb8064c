#pragma once

#include <cstdint>

#include <absl/status/statusor.h>

#include "storage/sqlite/database.h"

struct sqlite3_file;

// The files that SQLite has open, by its own descriptors: one of ours would drop SQLite's locks
// when it is closed.
namespace uplink::storage::sqlite {

/// Errors: kUnavailable if it is not open.
[[nodiscard]] absl::StatusOr<sqlite3_file*> OpenDatabaseFile(const Database& database);
[[nodiscard]] absl::StatusOr<sqlite3_file*> OpenWalFile(const Database& database);

/// In bytes.
///
/// Errors: kUnavailable if it cannot be asked.
[[nodiscard]] absl::StatusOr<std::int64_t> SizeOf(const Database& database, sqlite3_file* file);

}  // namespace uplink::storage::sqlite
