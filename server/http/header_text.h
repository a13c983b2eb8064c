#pragma once

#include <algorithm>
#include <string>
#include <string_view>

#include "schema/base/clock.h"

namespace uplink::http {

/// Words of HTTP and host names are the same in any case; ASCII alone, whatever the locale.
[[nodiscard]] constexpr char LowerCase(char c) {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

[[nodiscard]] inline std::string LowerCase(std::string_view text) {
  std::string lower(text);
  std::ranges::transform(lower, lower.begin(), [](char c) { return LowerCase(c); });
  return lower;
}

[[nodiscard]] inline bool SameWord(std::string_view a, std::string_view b) {
  return std::ranges::equal(a, b, [](char x, char y) { return LowerCase(x) == LowerCase(y); });
}

/// The value of a Date header, such as `Sun, 06 Nov 1994 08:49:37 GMT` (RFC 9110, 5.6.7), whatever
/// the locale. Years from 0 to 9999.
[[nodiscard]] std::string ImfFixdate(SystemTime time);

}  // namespace uplink::http
