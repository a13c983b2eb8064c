#pragma once

#include <cstddef>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include <unistd.h>

#include "schema/base/clock.h"
#include "tools/terminal/terminal.h"
#include "tools/uplink-fleet/report/live_table.h"

namespace uplink::synthetic {

/// How a run goes, on standard error: a table that updates in place each second on a terminal,
/// plain lines less often elsewhere.
///
/// Thread: confined to one thread.
class LiveDisplay final {
 public:
  /// `terminal` is that of standard error.
  explicit LiveDisplay(const Terminal& terminal) : terminal_(terminal) {}

  /// True when the next look is due; the one after it is due an interval later.
  [[nodiscard]] bool Due(SteadyTime now) {
    if (now < next_) return false;
    next_ = now + (terminal_.updates ? kEvery : kPlainEvery);
    return true;
  }

  /// The table on a terminal, the line elsewhere.
  void Show(const std::string& line, LiveTable table) {
    table_ = std::move(table);
    if (terminal_.updates) {
      Put();
    } else {
      Write(line + "\n");
    }
  }
  /// The line, as the heading of the rows that were shown last.
  void Show(const std::string& line) { Show(line, {.heading = line, .rows = table_.rows}); }

  void Clear() {
    if (terminal_.updates && shown_ > 0) Write(PutOver(shown_, {}));
    shown_ = 0;
  }

 private:
  static constexpr milliseconds kEvery{1000};
  static constexpr milliseconds kPlainEvery{5000};

  void Put() {
    const TerminalSize size = SizeOf(STDERR_FILENO);
    std::vector<std::string> lines = LinesOf(table_, size, Palette(terminal_));
    // Apart from what stands above, where there is room.
    if (lines.size() + 1 < size.rows) lines.insert(lines.begin(), "");
    Write(PutOver(shown_, lines));
    shown_ = lines.size();
  }
  static void Write(const std::string& text) {
    std::fputs(text.c_str(), stderr);
    std::fflush(stderr);
  }

  const Terminal terminal_;
  SteadyTime next_{};
  LiveTable table_;
  /// Lines of the table that stand on the terminal.
  std::size_t shown_ = 0;
};

}  // namespace uplink::synthetic
