#include "storage/disk_space.h"

#include <cerrno>
#include <system_error>

#include <absl/status/status.h>
#include <sys/statvfs.h>

namespace uplink::storage {

absl::StatusOr<DiskSpace> DiskSpaceOf(const std::string& path) {
  struct statvfs disk {};
  if (::statvfs(path.c_str(), &disk) != 0) {
    return absl::UnavailableError(
        "the space of " + path + " cannot be asked for: " + std::generic_category().message(errno));
  }
  const std::uint64_t block = disk.f_frsize;
  return DiskSpace{.free_bytes = disk.f_bavail * block, .total_bytes = disk.f_blocks * block};
}

}  // namespace uplink::storage
