#pragma once

#include <cstdint>
#include <optional>

#include <sys/types.h>

namespace uplink::synthetic {

/// What a process used: CPU since its start, or over a while, and memory at the end of it. A value.
struct ProcessUse {
  double cpu_seconds = 0;
  std::uint64_t rss_bytes = 0;

  /// From `before` until this.
  [[nodiscard]] ProcessUse Since(const ProcessUse& before) const {
    return {cpu_seconds - before.cpu_seconds, rss_bytes};
  }
};

/// What the kernel says of a process of this machine (/proc/PID/stat, statm); none if there is no
/// such process. CPU is known to the kernel's tick, 10 ms.
[[nodiscard]] std::optional<ProcessUse> UseOf(pid_t pid);

/// The process of this machine that listens on that TCP port; nothing if there is none or this
/// user may not see it.
[[nodiscard]] std::optional<pid_t> ListenerOf(std::uint16_t port);

}  // namespace uplink::synthetic
