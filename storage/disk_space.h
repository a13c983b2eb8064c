#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include <absl/status/statusor.h>

namespace uplink::storage {

/// What a store may still write, and the size of the disk that it writes to, in bytes. A value.
struct DiskSpace {
  std::uint64_t free_bytes = 0;
  std::uint64_t total_bytes = 0;
  /// Of that disk: what the WAL of an SQLite store takes.
  std::optional<std::uint64_t> wal_bytes = std::nullopt;

  friend bool operator==(const DiskSpace&, const DiskSpace&) = default;
};

/// Of the disk that `path` lies on: what programs without special rights may still write there.
/// Quotas of a user or a folder do not show. May wait for a disk on the network. Any thread.
///
/// Errors: kUnavailable, with the path.
[[nodiscard]] absl::StatusOr<DiskSpace> DiskSpaceOf(const std::string& path);

}  // namespace uplink::storage
