#pragma once

#include <memory>
#include <string>

#include <absl/status/statusor.h>

#include "schema/base/clock.h"
#include "storage/sqlite/database.h"

namespace uplink::storage::sqlite {

/// How long a call of such a connection waits for another writer of the file.
inline constexpr milliseconds kBusyTimeout{5'000};

/// A connection for short writes beside the store's writer, which take no lock but SQLite's own.
/// The file must be there and migrated; nothing is created.
///
/// Errors: kFailedPrecondition, naming the path: no file, not ours, not this program's schema
///         version.
[[nodiscard]] absl::StatusOr<std::unique_ptr<Database>> OpenBeside(const std::string& path);

}  // namespace uplink::storage::sqlite
