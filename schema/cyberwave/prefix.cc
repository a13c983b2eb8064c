#include "schema/cyberwave/prefix.h"

#include "schema/base/utf8.h"

namespace uplink::cyberwave {
namespace {

constexpr std::string_view kUnreserved =
    "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-._~";
constexpr unsigned kBitsOfDigit = 4;
constexpr unsigned kDigitMask = 0xF;

}  // namespace

std::string PercentEncoded(std::string_view text) {
  static constexpr std::string_view kDigits = "0123456789ABCDEF";
  std::string encoded;
  encoded.reserve(text.size());
  for (const char c : text) {
    if (kUnreserved.find(c) != std::string_view::npos) {
      encoded += c;
      continue;
    }
    const auto byte = static_cast<unsigned char>(c);
    encoded += '%';
    encoded += kDigits[byte >> kBitsOfDigit];
    encoded += kDigits[byte & kDigitMask];
  }
  return encoded;
}

std::string_view PrefixError(std::string_view prefix) {
  if (CountControls(prefix) != 0U) return "it is not UTF-8, or holds control characters";
  if (prefix.find_first_of("+#") != std::string_view::npos) return "it holds a wildcard (+, #)";
  if (prefix.starts_with('$')) return "topics that begin with $ are the broker's own";
  if (PercentEncoded(prefix).size() > kPrefixEncodedBytesMax) return "it is too long for a RURI";
  return {};
}

}  // namespace uplink::cyberwave
