#pragma once

#include <cstdint>
#include <span>

namespace uplink::storage::sqlite {

/// One step of the schema, built in from storage/migrations/sqlite. A released step is never
/// edited.
struct Migration {
  std::int64_t version = 0;
  const char* name = nullptr;
  const char* sha256 = nullptr;
  const char* sql = nullptr;
};

/// All steps, from version 1, without a hole. Immutable.
[[nodiscard]] std::span<const Migration> Migrations();

}  // namespace uplink::storage::sqlite
