#pragma once

#include <cstdint>

#include "schema/base/clock.h"
#include "storage/types.h"

namespace uplink::storage::postgres {

/// The last upsert in a batch of an entry that is present: a raised fault, a shape or an object.
/// The pointers lead into the batch.
template <typename Body>
struct Upserted {
  const CommitRecord* record = nullptr;
  const Body* body = nullptr;
  /// The effective one, Unix milliseconds; 0: never.
  std::int64_t expires_ms = 0;
  /// Of the upsert that made the entry present, if the batch did.
  SystemTime first_at;
  std::int32_t place = 0;
};

}  // namespace uplink::storage::postgres
