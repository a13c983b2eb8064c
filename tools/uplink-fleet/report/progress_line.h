#pragma once

#include <cstdio>
#include <string>

#include <unistd.h>

#include "schema/base/clock.h"

namespace uplink::synthetic {

/// How a run goes, on standard error: one line per second that is overwritten on a terminal, plain
/// lines less often elsewhere.
///
/// Thread: confined to one thread.
class ProgressLine final {
 public:
  /// True when the next line is due; the one after it is due an interval later.
  [[nodiscard]] bool Due(SteadyTime now) {
    if (now < next_) return false;
    next_ = now + (terminal_ ? kEvery : kPlainEvery);
    return true;
  }

  void Show(const std::string& line) const {
    const std::string text = terminal_ ? kClear + line : line + "\n";
    std::fputs(text.c_str(), stderr);
    std::fflush(stderr);
  }

  void Clear() const {
    if (terminal_) std::fputs(kClear, stderr);
  }

 private:
  static constexpr milliseconds kEvery{1000};
  static constexpr milliseconds kPlainEvery{5000};
  static constexpr const char* kClear = "\r\x1b[K";

  SteadyTime next_{};
  bool terminal_ = isatty(STDERR_FILENO) == 1;
};

}  // namespace uplink::synthetic
