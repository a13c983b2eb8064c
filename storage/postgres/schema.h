#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "storage/migration.h"
#include "storage/postgres/link/connection.h"

// The schema `uplinkd` of a database: its version, its migrations, who may use it.
//
// Errors: beside those of the connection, those of CheckApplied and of TablesWithoutSteps, and
//         kFailedPrecondition, with what to do, where the role may not read the schema.
namespace uplink::storage::postgres {

struct AppliedSchema {
  /// That of its last step; 0 if there is none.
  std::int64_t version = 0;
  /// Those of `migrations` that it lacks, or why this program may not use it.
  absl::StatusOr<std::span<const Migration>> missing;
};
[[nodiscard]] absl::StatusOr<AppliedSchema> ReadSchema(Connection& connection,
                                                       std::span<const Migration> migrations);

/// OK if this program may use the schema and none of `migrations` is missing (kFailedPrecondition).
[[nodiscard]] absl::Status CheckSchema(Connection& connection,
                                       std::span<const Migration> migrations);

/// Applies the steps that are missing, each in a transaction, under an advisory lock: a second
/// process waits and finds nothing left to do. Grants what new steps made to the roles that
/// GrantTo named before. Returns the names of the steps that it applied.
[[nodiscard]] absl::StatusOr<std::vector<std::string>> Migrate(
    Connection& connection, std::span<const Migration> migrations);

/// Lets the role do what the server does, and no more: read and write rows, run our functions.
/// Migrations to come are granted to it as well.
[[nodiscard]] absl::Status GrantTo(Connection& connection, const std::string& role);

}  // namespace uplink::storage::postgres
