#pragma once

#include <cstddef>

#include "server/config/config.h"

namespace uplink {

/// Sets what holds for the whole process: libraries, signals that are none of ours, descriptors.
/// Returns how many descriptors may be open. Before the first thread, and before gRPC is used.
std::size_t SetUpProcess(const config::Config& config);

}  // namespace uplink
