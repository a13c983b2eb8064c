#pragma once

#include <cstddef>

#include "server/cyberwave/records.h"
#include "storage/types.h"

namespace uplink::cyberwave {

/// What a store is given of a record, which is moved from: one of a robot's kinds, or an update of
/// what is no robot. `payload_bytes` is the size of the payload as it came. Pure; any thread.
[[nodiscard]] storage::CommitContent CommitContentOf(DurableRecord&& record,
                                                     std::size_t payload_bytes);

}  // namespace uplink::cyberwave
