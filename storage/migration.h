#pragma once

#include <cstdint>

namespace uplink::storage {

/// One step of a store's schema, built in from storage/migrations. A released step is never edited.
struct Migration {
  std::int64_t version = 0;
  const char* name = nullptr;
  const char* sha256 = nullptr;
  const char* sql = nullptr;
};

}  // namespace uplink::storage
