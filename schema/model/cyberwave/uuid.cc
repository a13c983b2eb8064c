#include "schema/model/cyberwave/uuid.h"

#include <array>
#include <cstddef>
#include <cstdint>

namespace uplink::model::cyberwave {
namespace {

constexpr unsigned kDecimalDigits = 10;
constexpr unsigned kBitsOfDigit = 4;
constexpr unsigned kDigitMask = 0xF;

/// Of a character that is no digit.
constexpr std::uint8_t kNoDigit = 0xFF;

/// The digit that each character is, in either case: a look where comparisons would be two dozen
/// jumps that no processor foresees.
constexpr std::array<std::uint8_t, 256> DigitsByCharacter() {
  std::array<std::uint8_t, 256> digits{};
  digits.fill(kNoDigit);
  for (unsigned i = 0; i < kDecimalDigits; ++i) digits.at('0' + i) = static_cast<std::uint8_t>(i);
  for (unsigned i = kDecimalDigits; i <= kDigitMask; ++i) {
    digits.at('a' + i - kDecimalDigits) = static_cast<std::uint8_t>(i);
    digits.at('A' + i - kDecimalDigits) = static_cast<std::uint8_t>(i);
  }
  return digits;
}
constexpr std::array<std::uint8_t, 256> kDigits = DigitsByCharacter();

unsigned HexDigit(char digit) { return kDigits[static_cast<unsigned char>(digit)]; }

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
    const unsigned high = HexDigit(text[at]);
    const unsigned low = HexDigit(text[at + 1]);
    if (high == kNoDigit || low == kNoDigit) return std::nullopt;
    id.bytes_[i] = static_cast<std::uint8_t>(high << kBitsOfDigit | low);
    at += 2;
  }
  return id;
}

std::string Uuid::ToText() const {
  static constexpr std::string_view kTexts = "0123456789abcdef";
  std::string text(kTextBytes, '-');
  std::size_t at = 0;
  for (std::size_t i = 0; i < kBytes; ++i) {
    if (HyphenBefore(i)) ++at;
    text[at++] = kTexts[bytes_[i] >> kBitsOfDigit];
    text[at++] = kTexts[bytes_[i] & kDigitMask];
  }
  return text;
}

}  // namespace uplink::model::cyberwave
