#pragma once

#include <cstdint>

namespace uplink::storage {

/// Drawn from the store's one sequence whenever a robot's stream is opened, it is adopted, a drone
/// is claimed, or a lease on topics is taken: from 1, never the same twice, and of one robot or
/// client id ever greater, even if its row went in between.
using Epoch = std::uint64_t;

}  // namespace uplink::storage
