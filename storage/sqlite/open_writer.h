#pragma once

#include <memory>
#include <string>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "storage/sqlite/database.h"
#include "storage/sqlite/store.h"

namespace uplink::storage::sqlite {

/// The writer's connection to a store: the file is checked, migrated and set up.
///
/// Errors: kFailedPrecondition above all, as of SqliteStore::Open.
[[nodiscard]] absl::StatusOr<std::unique_ptr<Database>> OpenWriter(const std::string& path,
                                                                   const StoreOptions& options);

/// How a start ends that `failed`. Damage is noted, so that the next start reads the whole file:
/// kFailedPrecondition then, naming the file and what to do. Anything else stays as it is.
[[nodiscard]] absl::Status StartFailed(Database& database, const absl::Status& failed);

}  // namespace uplink::storage::sqlite
