#include "tools/terminal/terminal.h"

#include <fmt/core.h>
#include <sys/ioctl.h>
#include <unistd.h>

namespace uplink {

std::string_view VariableIn(const char* const* environment, std::string_view name) {
  for (; environment != nullptr && *environment != nullptr; ++environment) {
    const std::string_view entry(*environment);
    if (entry.starts_with(name) && entry.substr(name.size()).starts_with('=')) {
      return entry.substr(name.size() + 1);
    }
  }
  return {};
}

Terminal TerminalOf(int descriptor, const char* const* environment) {
  const std::string_view term = VariableIn(environment, "TERM");
  Terminal terminal;
  terminal.updates = isatty(descriptor) == 1 && !term.empty() && term != "dumb";
  terminal.colours = terminal.updates && VariableIn(environment, "NO_COLOR").empty();
  return terminal;
}

TerminalSize SizeOf(int descriptor) {
  winsize size{};
  if (ioctl(descriptor, TIOCGWINSZ, &size) != 0 || size.ws_col == 0 || size.ws_row == 0) return {};
  return {.columns = size.ws_col, .rows = size.ws_row};
}

std::string Palette::Painted(std::string_view code, std::string_view text) const {
  if (!on_ || text.empty()) return std::string(text);
  return fmt::format("\x1b[{}m{}\x1b[0m", code, text);
}

}  // namespace uplink
