#pragma once

#include <memory>
#include <string>

#include <absl/status/statusor.h>

#include "schema/base/clock.h"
#include "storage/sqlite/damage.h"
#include "storage/sqlite/database.h"
#include "storage/sqlite/file_lock.h"

namespace uplink::storage::sqlite {

/// How long a call of such a connection waits for another writer of the file.
inline constexpr milliseconds kBusyTimeout{5'000};

/// A connection that only reads, beside the store's writer. The file must be there and migrated.
/// What it finds damaged afterwards, `damage` is told.
///
/// Errors: kFailedPrecondition, naming the path: no file, not ours, not this program's schema
///         version, since a reader cannot migrate.
[[nodiscard]] absl::StatusOr<std::unique_ptr<Database>> OpenToRead(const std::string& path,
                                                                   milliseconds busy_timeout,
                                                                   DamagePtr damage);

/// A connection for short writes beside the store's writer, which take no lock but SQLite's own.
/// The file must be there and migrated; nothing is created. Damage: as with OpenToRead.
///
/// Goes as a whole: the database first.
struct Beside {
  /// That the file's server, if there is one, has it by the same name.
  std::unique_ptr<FileLock> joined;
  std::unique_ptr<Database> database;
};

/// Errors: kFailedPrecondition, naming the path: no file, not ours, not this program's schema
///         version, or another name of it (FileLock::Join).
[[nodiscard]] absl::StatusOr<Beside> OpenBeside(const std::string& path, DamagePtr damage);

}  // namespace uplink::storage::sqlite
