#pragma once

#include <memory>
#include <string_view>

#include <unistd.h>

#include "schema/base/clock.h"
#include "server/log/line_queue.h"
#include "server/log/logger.h"

namespace uplink::log {

/// What a line begins with where journald reads it, `<4>` for a warning: the levels of syslog, as
/// sd-daemon(3) has it.
[[nodiscard]] std::string_view PriorityOf(Level level);

struct StandardErrorOptions {
  Format format = Format::kText;
  /// Each line begins with its priority, `<4>` for a warning, as journald reads it.
  bool priorities = false;
  LineQueue::Limits limits;
  /// For tests.
  int descriptor = STDERR_FILENO;
};

/// Lines to standard error, by a thread of its own, which alone waits for the reader. The lines
/// that were dropped meanwhile are a line themselves, `log_lines_lost`, once there is room; so are
/// those that could not be written (a full disk, a closed pipe).
///
/// Its end waits for the reader as well, kFlushWait at most. `clock` stamps the lines about losses
/// and outlives it.
[[nodiscard]] std::unique_ptr<LineSink> StandardError(const Clock& clock,
                                                      const StandardErrorOptions& options);

}  // namespace uplink::log
