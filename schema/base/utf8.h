#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace uplink {

/// True if `text` is well-formed UTF-8 (RFC 3629: no overlong forms, no surrogates) without NUL.
[[nodiscard]] bool IsCleanUtf8(std::string_view text);

/// The longest prefix of `text` of at most `bytes_max` bytes that does not split a code point.
/// `text` must be well-formed UTF-8.
[[nodiscard]] std::string_view Utf8Prefix(std::string_view text, std::size_t bytes_max);

/// `text` fit for a frame, a log or a terminal: bytes that are not part of well-formed UTF-8,
/// control characters, and marks that turn the direction of what follows or end a line, are shown
/// as `\xHH`; the result has at most `bytes_max` bytes and splits no code point.
[[nodiscard]] std::string PrintableUtf8(std::string_view text, std::size_t bytes_max);

}  // namespace uplink
