#pragma once

#include <cstddef>

namespace uplink::transport {

/// Cores that this process may use, which may be fewer than the machine has: two threads of streams
/// on one core cost half as much again as one (measured). At least one.
[[nodiscard]] std::size_t UsableCores();

}  // namespace uplink::transport
