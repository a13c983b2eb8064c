#pragma once

#include <cstdint>

#include "storage/sqlite/entry_number.h"
#include "storage/types.h"

namespace uplink::storage::sqlite {

/// An upsert of an entry that is present: a raised fault, a shape or an object. The pointers lead
/// into the batch.
template <typename Body>
struct Upserted {
  const CommitRecord* record = nullptr;
  const Body* body = nullptr;
  /// The effective one, Unix milliseconds; 0: never.
  std::int64_t expires_ms = 0;
  EntryNumber entry = 0;
};

}  // namespace uplink::storage::sqlite
