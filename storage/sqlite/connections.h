#pragma once

#include <memory>
#include <string>
#include <utility>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "schema/base/clock.h"
#include "storage/sqlite/damage.h"
#include "storage/sqlite/database.h"
#include "storage/sqlite/file_lock.h"
#include "storage/sqlite/store.h"

namespace uplink::storage::sqlite {

/// The writer's connection to a store: the file is checked, migrated and set up.
///
/// Errors: kFailedPrecondition above all, as of SqliteStore::Open.
[[nodiscard]] absl::StatusOr<std::unique_ptr<Database>> OpenWriter(const std::string& path,
                                                                   const StoreOptions& options);

/// The status with which a start ends after the error `failed`. Damage: kFailedPrecondition, naming
/// the file and what to do, and noted, so that the next start reads the whole file. Else `failed`.
[[nodiscard]] absl::Status StatusOfFailedStart(Database& database, const absl::Status& failed);

/// How long a call of such a connection waits for another writer of the file.
inline constexpr milliseconds kBusyTimeout{5'000};

/// A connection that only reads, beside the store's writer. The file must exist and be migrated.
/// Damage that the connection finds later is reported to `damage`.
///
/// Errors: kFailedPrecondition, naming the path: no file, not ours, not this program's schema
///         version, since a reader cannot migrate.
[[nodiscard]] absl::StatusOr<std::unique_ptr<Database>> OpenToRead(const std::string& path,
                                                                   milliseconds busy_timeout,
                                                                   DamagePtr damage);

/// A connection for short writes beside the store's writer, which take no lock but SQLite's own.
/// The file must exist and be migrated; nothing is created. Damage: as with OpenToRead.
///
/// `database` is destroyed before `joined`.
struct SideConnection {
  /// Shows that the file's server, if one runs, has it open by the same name.
  std::unique_ptr<FileLock> joined;
  std::unique_ptr<Database> database;
};

/// Errors: kFailedPrecondition, naming the path: no file, not ours, not this program's schema
///         version, or another name of it (FileLock::Join).
[[nodiscard]] absl::StatusOr<SideConnection> OpenSideConnection(const std::string& path,
                                                                DamagePtr damage);

/// A Part over a connection of its own, once its statements are prepared. Errors: as
/// OpenSideConnection.
template <typename Part, typename... Args>
[[nodiscard]] absl::StatusOr<std::unique_ptr<Part>> MakeOnSideConnection(const std::string& path,
                                                                         DamagePtr damage,
                                                                         const Args&... args) {
  auto side = OpenSideConnection(path, std::move(damage));
  if (!side.ok()) return side.status();
  auto part = std::make_unique<Part>(*std::move(side), args...);
  absl::Status prepared = part->Prepare();
  if (!prepared.ok()) return prepared;
  return part;
}

}  // namespace uplink::storage::sqlite
