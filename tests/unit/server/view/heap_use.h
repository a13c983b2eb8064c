#pragma once

#include <cstddef>

namespace uplink::view {

/// Bytes that operator new has given out and not got back: now, and at most since the last
/// BeginPeak. Linking it replaces operator new and delete. Thread-safe.
[[nodiscard]] std::size_t HeapBytes();
[[nodiscard]] std::size_t HeapBytesPeak();
void BeginPeak();

}  // namespace uplink::view
