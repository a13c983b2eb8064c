#pragma once

#include <cstddef>

#include "schema/model/record.h"
#include "schema/model/rejection.h"
#include "schema/model/scope_update.h"

namespace uplink::model {

/// What a value holds in memory besides itself, in bytes: what its texts and lists have allocated,
/// with what each allocation costs. A few nanoseconds per text.
[[nodiscard]] std::size_t HeldBytes(const Body& body);
[[nodiscard]] std::size_t HeldBytes(const Record& record);
[[nodiscard]] std::size_t HeldBytes(const Rejection& rejection);
[[nodiscard]] std::size_t HeldBytes(const ScopeUpdate& update);

}  // namespace uplink::model
