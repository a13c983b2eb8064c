#pragma once

#include <cstdint>

namespace uplink::journal {

/// What one step of the writer did.
enum class Step : std::uint8_t {
  /// Nothing waits.
  kIdle,
  /// One step of the work was done: streams opened, a batch committed, or its outcomes told.
  kWorked,
  /// The store failed; the same work is tried again by a later step, after a pause.
  kFailed,
};

}  // namespace uplink::journal
