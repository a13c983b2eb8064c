#pragma once

#include <chrono>
#include <cstddef>

namespace uplink::storage::postgres {

// What the options of PostgreSQL's store and reader are unless they are set; server/config takes
// its defaults from here.

/// How long one call of the store may take.
inline constexpr std::chrono::milliseconds kCallTimeoutDefault{10'000};
/// Reads that run at once.
inline constexpr std::size_t kReadersDefault = 2;

}  // namespace uplink::storage::postgres
