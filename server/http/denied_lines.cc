#include "server/http/denied_lines.h"

#include <utility>

namespace uplink::http {

void DeniedLines::Window::Turn(SteadyTime now) {
  if (lines > 0 && now < start + kSpan) return;
  start = now;
  lines = 0;
}

void DeniedLines::Write(const Line& line, const Source& source, SteadyTime now) {
  std::uint64_t suppressed = 0;
  {
    const std::lock_guard lock(mutex_);
    Window& window = sources_.Touch({source, line.why});
    window.Turn(now);
    all_.Turn(now);
    // What had no room among all is told by the next line of any source: its own may never return.
    if (window.lines >= kLinesPerSource) {
      ++window.suppressed;
      return;
    }
    if (all_.lines >= kLinesMax) {
      ++all_.suppressed;
      return;
    }
    ++window.lines;
    ++all_.lines;
    suppressed = std::exchange(window.suppressed, 0) + std::exchange(all_.suppressed, 0);
  }
  logger_.Warn("http_denied", {{"why", ToText(line.why)},
                               {"route", line.route},
                               {"name", line.name},
                               {"from", line.from},
                               {"suppressed", suppressed}});
}

}  // namespace uplink::http
