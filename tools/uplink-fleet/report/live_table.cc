#include "tools/uplink-fleet/report/live_table.h"

#include <algorithm>
#include <chrono>

#include <fmt/core.h>

namespace uplink::synthetic {

std::string SendingHeading(std::string_view who, std::int64_t seconds, milliseconds run_for) {
  const auto all = std::chrono::ceil<std::chrono::seconds>(run_for).count();
  return fmt::format("{} send: {} of {} s", who, std::min(seconds, all), all);
}

std::string SettlingHeading(std::int64_t seconds) {
  return fmt::format("{} s: the server settles the rest, and is looked at", seconds);
}

std::vector<std::string> LinesOf(const LiveTable& table, const TerminalSize& size,
                                 const Palette& palette) {
  std::size_t name_width = 0;
  std::size_t value_width = 0;
  for (const auto& [name, value] : table.rows) {
    name_width = std::max(name_width, name.size());
    value_width = std::max(value_width, value.size());
  }
  // A line that fills the last column would make some terminals go on to the next.
  const std::size_t columns = std::max<std::size_t>(size.columns, 2) - 1;
  std::vector<std::string> lines{palette.Heading(table.heading.substr(0, columns))};
  for (const auto& [name, value] : table.rows) {
    lines.push_back(
        fmt::format("  {:<{}}  {:>{}}", name, name_width, value, value_width).substr(0, columns));
  }
  lines.resize(std::min(lines.size(), std::max<std::size_t>(size.rows, 2) - 1));
  return lines;
}

std::string PutOver(std::size_t shown, const std::vector<std::string>& lines) {
  std::string text = shown > 0 ? fmt::format("\r\x1b[{}A", shown) : "\r";
  for (const std::string& line : lines) text += line + "\x1b[K\n";
  return text + "\x1b[J";
}

}  // namespace uplink::synthetic
