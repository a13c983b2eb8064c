#pragma once

#include <cstddef>

namespace uplink::run {

/// Sets what holds for the whole process: libraries, ignored signals, the limit of descriptors.
/// Returns that limit. Call it before the first thread.
std::size_t SetUpProcess();

}  // namespace uplink::run
