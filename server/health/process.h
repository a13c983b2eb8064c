#pragma once

#include <cstddef>
#include <optional>

namespace uplink::health {

/// The process as the kernel sees it. A value.
struct ProcessFigures {
  double cpu_seconds = 0;
  std::size_t resident_bytes = 0;
  std::size_t virtual_bytes = 0;
  /// The limit of virtual_bytes, if there is one.
  std::optional<std::size_t> virtual_max_bytes;
  std::size_t threads = 0;
};

/// Reads /proc/self; a figure that cannot be read is 0. Any thread.
[[nodiscard]] ProcessFigures ReadProcess();

/// Open file descriptors, and how many may be open (soft RLIMIT_NOFILE). Counts the entries of
/// /proc/self/fd: for probes and scrapes, not for each message.
[[nodiscard]] std::size_t OpenDescriptors();
[[nodiscard]] std::size_t DescriptorsMax();

/// Memory that the process may use: the machine's, or what its control groups leave it
/// (memory_limit.h).
[[nodiscard]] std::size_t MemoryMax();

/// Raises the soft RLIMIT_NOFILE to the hard one; returns the soft one after that.
std::size_t RaiseDescriptorsMax();

}  // namespace uplink::health
