#pragma once

#include <cstddef>
#include <string>

namespace uplink::health {

/// Where the kernel tells of this process's control groups; a test names files of its own.
struct GroupFiles {
  /// A line per hierarchy: `0::/path` (version 2) or `4:memory:/path` (version 1).
  std::string groups = "/proc/self/cgroup";
  /// Where the hierarchies are mounted, and from which of their groups on.
  std::string mounts = "/proc/self/mountinfo";
};

/// The least of `machine_bytes` and what the control groups of this process may use: its own and
/// every one above it that can be seen, of version 2 (memory.max) and 1 (memory.limit_in_bytes).
/// What cannot be read is no limit.
///
/// Limits: kMountLinesMax lines of the mounts are read.
/// Thread: any; reads a few files of the kernel's.
[[nodiscard]] std::size_t MemoryLimit(const GroupFiles& files, std::size_t machine_bytes);

/// Lines of a table of mounts that are read; a machine with many containers has some thousand.
inline constexpr std::size_t kMountLinesMax = 100'000;

}  // namespace uplink::health
