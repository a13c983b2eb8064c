#pragma once

#include <cstddef>
#include <string>

namespace uplink::health {

/// Where the kernel lists this process's control groups; a test names its own files.
struct GroupFiles {
  /// A line per hierarchy: `0::/path` (version 2) or `4:memory:/path` (version 1).
  std::string groups = "/proc/self/cgroup";
  /// Where each hierarchy is mounted, and which of its groups is the root of that mount.
  std::string mounts = "/proc/self/mountinfo";
};

/// The least of `machine_bytes` and the limits of this process's control groups: its own and every
/// visible one above it, in version 2 (memory.max) and 1 (memory.limit_in_bytes). A limit that
/// cannot be read does not count.
///
/// Limits: kMountLinesMax lines of the mounts are read.
/// Thread: any; reads a few files of the kernel's.
[[nodiscard]] std::size_t MemoryLimit(const GroupFiles& files, std::size_t machine_bytes);

/// Lines of a table of mounts that are read; a machine with many containers has some thousand.
inline constexpr std::size_t kMountLinesMax = 100'000;

}  // namespace uplink::health
