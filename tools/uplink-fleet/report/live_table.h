#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "schema/base/clock.h"
#include "tools/terminal/terminal.h"

namespace uplink::synthetic {

/// What people see of a run while it goes on: what it does now, and named values. A value.
struct LiveTable {
  std::string heading;
  std::vector<std::pair<std::string, std::string>> rows;
};

/// Headings of a run by `who`, so many seconds after its beginning.
[[nodiscard]] std::string SendingHeading(std::string_view who, std::int64_t seconds,
                                         milliseconds run_for);
[[nodiscard]] std::string SettlingHeading(std::int64_t seconds);

/// Its lines: names to the left, values to the right, each cut to the terminal's width, and no more
/// than leave the terminal a line below them. Pure.
[[nodiscard]] std::vector<std::string> LinesOf(const LiveTable& table, const TerminalSize& size,
                                               const Palette& palette);

/// What puts `lines` over the `shown` lines above the cursor, which is at the beginning of the line
/// below them, and removes what is left of those. Pure.
[[nodiscard]] std::string PutOver(std::size_t shown, const std::vector<std::string>& lines);

}  // namespace uplink::synthetic
