#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

namespace uplink::storage {

/// One step of a store's schema, built in from storage/migrations. A released step is never edited.
struct Migration {
  std::int64_t version = 0;
  /// The schema of the oldest program that may use a store with this step.
  std::int64_t oldest = 0;
  const char* name = nullptr;
  const char* sha256 = nullptr;
  const char* sql = nullptr;
};

/// A step that a store has, as it is noted there.
struct AppliedStep {
  std::int64_t version = 0;
  /// 0: an earlier build applied it, which noted none.
  std::int64_t oldest = 0;
  std::string sha256;
};

/// OK if a program of schema `ours` may use a store of schema `newest`, whose steps let programs in
/// from schema `oldest` on. `store` names the store in the error.
///
/// Errors: kUnimplemented, one sentence that says what to do: this program can never use the store.
[[nodiscard]] absl::Status CheckOldest(std::string_view store, std::int64_t oldest,
                                       std::int64_t newest, std::int64_t ours);

/// A store has tables of ours, and none of the steps that made them is noted.
///
/// Errors: always kFailedPrecondition, one sentence that says what to do.
[[nodiscard]] absl::Status TablesWithoutSteps(std::string_view store);

/// Whether a program of the steps `ours` may use a store that has `applied`, in the order of their
/// versions; returns those of its steps that the store lacks. Steps that the program does not know
/// are no hindrance, unless one of them shuts it out (CheckOldest).
///
/// Errors: kUnimplemented as CheckOldest, also if the store is an earlier build's, or has another
///         step under one of our numbers.
[[nodiscard]] absl::StatusOr<std::span<const Migration>> CheckApplied(
    std::string_view store, std::span<const AppliedStep> applied, std::span<const Migration> ours);

}  // namespace uplink::storage
