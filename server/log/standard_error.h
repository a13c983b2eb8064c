#pragma once

#include <memory>
#include <string_view>

#include <unistd.h>

#include "schema/base/clock.h"
#include "server/log/line_queue.h"
#include "server/log/logger.h"

namespace uplink::log {

/// The prefix with which journald learns a line's priority: `<4>` for a warning. Pure.
///
/// Source: sd-daemon(3); the numbers are syslog's levels.
[[nodiscard]] std::string_view PriorityOf(Level level);

struct StandardErrorOptions {
  /// The format of the lines about losses, which the sink writes itself.
  Format format = Format::kText;
  /// Whether each line begins with its priority (PriorityOf).
  bool priorities = false;
  LineQueue::Limits limits;
  /// Where lines go; tests set another. It outlives the sink, which does not close it.
  int descriptor = STDERR_FILENO;
};

/// A sink that writes lines to standard error on its own thread, the only one that waits for the
/// reader. Once there is room again, a line `log_lines_lost` says how many lines were dropped
/// meanwhile or could not be written (a full disk, a closed pipe).
///
/// Limits: LineQueue's. The destructor waits for the reader for kFlushWait at most.
/// Thread: the sink is thread-safe. `clock` stamps the lines about losses and outlives it.
[[nodiscard]] std::unique_ptr<LineSink> StandardError(const Clock& clock,
                                                      const StandardErrorOptions& options);

}  // namespace uplink::log
