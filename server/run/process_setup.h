#pragma once

#include <cstddef>

namespace uplink::run {

/// Sets what holds for the whole process: libraries, signals that are none of ours, descriptors.
/// Returns how many descriptors may be open. Before the first thread.
std::size_t SetUpProcess();

}  // namespace uplink::run
