#pragma once

#include <cstddef>

namespace uplink::session {

/// Calls of operator new in this program since its start. Linking it replaces operator new and
/// delete. Thread-safe.
[[nodiscard]] std::size_t AllocationsSoFar();

}  // namespace uplink::session
