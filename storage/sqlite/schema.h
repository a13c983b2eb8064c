#pragma once

#include <cstdint>
#include <span>

#include <absl/status/status.h>

#include "storage/sqlite/database.h"
#include "storage/sqlite/migrations.h"

namespace uplink::storage::sqlite {

/// "UPLK" in the file's header: the file is ours.
inline constexpr std::int64_t kApplicationId = 0x55504C4B;

/// What to do with a file whose schema is older than the program's.
enum class IfOlder : std::uint8_t { kMigrate, kRefuse };

/// Refuses what is neither empty nor ours, and what this program may not use (CheckApplied), before
/// anything in the file is touched.
///
/// Errors: kFailedPrecondition, naming the path; those of CheckApplied and of TablesWithoutSteps.
[[nodiscard]] absl::Status CheckFile(Database& database, std::span<const Migration> migrations);

/// Sets what durability rests on (WAL, synchronous FULL) and reads it back.
///
/// Errors: kFailedPrecondition if SQLite did not take a setting.
[[nodiscard]] absl::Status ConfigureWriter(Database& database);

/// Applies those of `migrations` that the file lacks, each step in a transaction of its own.
///
/// Errors: those of CheckApplied; kFailedPrecondition if steps are missing and `if_older` is
///         kRefuse.
[[nodiscard]] absl::Status Migrate(Database& database, std::span<const Migration> migrations,
                                   IfOlder if_older);

}  // namespace uplink::storage::sqlite
