#include "schema/model/cyberwave/uuid.h"

namespace uplink::model::cyberwave {
namespace {

constexpr unsigned kDecimalDigits = 10;
constexpr unsigned kBitsOfDigit = 4;
constexpr unsigned kDigitMask = 0xF;

std::optional<unsigned> HexDigit(char digit) {
  if (digit >= '0' && digit <= '9') return static_cast<unsigned>(digit - '0');
  if (digit >= 'a' && digit <= 'f') return static_cast<unsigned>(digit - 'a') + kDecimalDigits;
  if (digit >= 'A' && digit <= 'F') return static_cast<unsigned>(digit - 'A') + kDecimalDigits;
  return std::nullopt;
}

/// Whether a hyphen stands before this byte: 8-4-4-4-12 digits are 4-2-2-2-6 bytes.
constexpr bool HyphenBefore(std::size_t byte) {
  return byte == 4 || byte == 6 || byte == 8 || byte == 10;
}

}  // namespace

std::optional<Uuid> Uuid::FromText(std::string_view text) {
  if (text.size() != kTextBytes) return std::nullopt;
  Uuid id;
  std::size_t at = 0;
  for (std::size_t i = 0; i < kBytes; ++i) {
    if (HyphenBefore(i) && text[at++] != '-') return std::nullopt;
    const std::optional<unsigned> high = HexDigit(text[at]);
    const std::optional<unsigned> low = HexDigit(text[at + 1]);
    if (!high || !low) return std::nullopt;
    id.bytes_.at(i) = static_cast<std::uint8_t>(*high << kBitsOfDigit | *low);
    at += 2;
  }
  return id;
}

std::string Uuid::ToText() const {
  static constexpr std::string_view kDigits = "0123456789abcdef";
  std::string text;
  text.reserve(kTextBytes);
  for (std::size_t i = 0; i < kBytes; ++i) {
    if (HyphenBefore(i)) text += '-';
    text += kDigits[bytes_.at(i) >> kBitsOfDigit];
    text += kDigits[bytes_.at(i) & kDigitMask];
  }
  return text;
}

}  // namespace uplink::model::cyberwave
