#pragma once

#include <cstdint>

namespace uplink::storage::sqlite {

/// The number of a row in the order of writing, over all tables.
using EntryNumber = std::uint64_t;

}  // namespace uplink::storage::sqlite
