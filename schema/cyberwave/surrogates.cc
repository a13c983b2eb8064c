#include "schema/cyberwave/surrogates.h"

#include <charconv>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <system_error>

namespace uplink::cyberwave {
namespace {

/// `\uXXXX`.
constexpr std::size_t kEscapeBytes = 6;
constexpr int kHex = 16;

/// The 16 bits of the escape at `at`; nothing if there is none.
std::optional<std::uint16_t> EscapeAt(std::string_view text, std::size_t at) {
  const std::string_view escape = text.substr(at < text.size() ? at : text.size(), kEscapeBytes);
  if (escape.size() < kEscapeBytes || !escape.starts_with("\\u")) return std::nullopt;
  std::uint16_t unit = 0;
  const char* const end = escape.data() + escape.size();
  const auto [rest, error] = std::from_chars(escape.data() + 2, end, unit, kHex);
  if (error != std::errc() || rest != end) return std::nullopt;
  return unit;
}

bool IsHigh(std::uint16_t unit) { return unit >= 0xD800 && unit <= 0xDBFF; }
bool IsLow(std::uint16_t unit) { return unit >= 0xDC00 && unit <= 0xDFFF; }

}  // namespace

bool HasLoneSurrogate(std::string_view text) {
  std::size_t at = 0;
  while ((at = text.find('\\', at)) != std::string_view::npos) {
    const std::optional<std::uint16_t> unit = EscapeAt(text, at);
    if (!unit) {
      at += 2;  // the character behind the backslash may be a backslash
      continue;
    }
    at += kEscapeBytes;
    if (IsLow(*unit)) return true;
    if (!IsHigh(*unit)) continue;
    const std::optional<std::uint16_t> next = EscapeAt(text, at);
    if (!next || !IsLow(*next)) return true;
    at += kEscapeBytes;
  }
  return false;
}

}  // namespace uplink::cyberwave
