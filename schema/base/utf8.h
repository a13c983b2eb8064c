#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace uplink {

/// Bytes of U+FFFD, the replacement character.
inline constexpr std::size_t kReplacementBytes = 3;

/// The control characters in `text` (Unicode's category Cc) other than tab, line feed and carriage
/// return; nothing if it is not well-formed UTF-8 (RFC 3629: no overlong forms, no surrogates)
/// without NUL. One pass.
[[nodiscard]] std::optional<std::size_t> CountControls(std::string_view text);

/// True if `text` is well-formed UTF-8 without NUL.
[[nodiscard]] inline bool IsCleanUtf8(std::string_view text) {
  return CountControls(text).has_value();
}

/// `text` with U+FFFD for each of its `controls` control characters. `text` must be well-formed
/// UTF-8, and `controls` what CountControls says of it.
[[nodiscard]] std::string ReplaceControls(std::string_view text, std::size_t controls);

/// The longest prefix of `text` of at most `bytes_max` bytes that does not split a code point.
/// `text` must be well-formed UTF-8.
[[nodiscard]] std::string_view Utf8Prefix(std::string_view text, std::size_t bytes_max);

/// `text` fit for a frame, a log or a terminal: bytes that are not part of well-formed UTF-8,
/// control characters, and marks that turn the direction of what follows or end a line, are shown
/// as `\xHH`; the result has at most `bytes_max` bytes and splits no code point.
[[nodiscard]] std::string PrintableUtf8(std::string_view text, std::size_t bytes_max);

}  // namespace uplink
