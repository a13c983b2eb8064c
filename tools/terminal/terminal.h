#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace uplink {

/// What a variable of an environment holds, which ends with a null pointer, as environ does; empty
/// if it is not set.
[[nodiscard]] std::string_view VariableIn(const char* const* environment, std::string_view name);

/// What may be written to one descriptor. A value.
struct Terminal {
  /// It is a terminal on which lines can be overwritten.
  bool updates = false;
  bool colours = false;
};

/// `environment` ends with a null pointer, as environ does.
///
/// Source: TERM=dumb knows no escape sequence; https://no-color.org: NO_COLOR, unless empty.
[[nodiscard]] Terminal TerminalOf(int descriptor, const char* const* environment);

/// How much fits on a terminal. A value.
struct TerminalSize {
  std::size_t columns = 80;
  std::size_t rows = 24;
};
/// That of a descriptor; the usual one if it does not say.
[[nodiscard]] TerminalSize SizeOf(int descriptor);

/// Colours for texts; without them each comes back as it is. A value.
class Palette final {
 public:
  explicit Palette(const Terminal& terminal) : on_(terminal.colours) {}

  [[nodiscard]] std::string Good(std::string_view text) const { return Painted("32", text); }
  [[nodiscard]] std::string Bad(std::string_view text) const { return Painted("1;31", text); }
  [[nodiscard]] std::string Heading(std::string_view text) const { return Painted("1", text); }
  [[nodiscard]] std::string Warning(std::string_view text) const { return Painted("33", text); }

 private:
  [[nodiscard]] std::string Painted(std::string_view code, std::string_view text) const;

  bool on_;
};

}  // namespace uplink
