#pragma once

#include <cstddef>
#include <string>

#include "storage/disk_space.h"
#include "tools/uplinkctl/doctor/finding.h"

namespace uplink::ctl {

/// Whether the store's disk has what storing needs; `free_min` is store.free_min. `place`: a folder
/// of it. A pure function.
[[nodiscard]] Finding DiskFinding(const std::string& place, const storage::DiskSpace& space,
                                  std::size_t free_min);

}  // namespace uplink::ctl
