#include "schema/base/utf8.h"

#include <bit>
#include <cstdint>
#include <cstring>

namespace uplink {
namespace {

bool IsContinuation(unsigned char byte) { return (byte & 0xC0U) == 0x80U; }

/// Bytes of the well-formed code point at the front of `text`; 0 if there is none.
std::size_t CodePointBytes(std::string_view text) {
  const auto at = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char lead = at(0);
  if (lead < 0x80) return 1;
  std::size_t bytes = 0;
  unsigned char second_min = 0x80;
  unsigned char second_max = 0xBF;
  if (lead >= 0xC2 && lead <= 0xDF) {
    bytes = 2;
  } else if (lead >= 0xE0 && lead <= 0xEF) {
    bytes = 3;
    if (lead == 0xE0) second_min = 0xA0;
    if (lead == 0xED) second_max = 0x9F;
  } else if (lead >= 0xF0 && lead <= 0xF4) {
    bytes = 4;
    if (lead == 0xF0) second_min = 0x90;
    if (lead == 0xF4) second_max = 0x8F;
  } else {
    return 0;
  }
  if (text.size() < bytes || at(1) < second_min || at(1) > second_max) return 0;
  for (std::size_t i = 2; i < bytes; ++i) {
    if (!IsContinuation(at(i))) return 0;
  }
  return bytes;
}

bool IsControl(unsigned char byte) { return byte < 0x20 || byte == 0x7F; }

/// The well-formed code point that begins there is a control character that a text goes without.
bool IsReplaced(std::string_view text) {
  const auto lead = static_cast<unsigned char>(text[0]);
  // U+0080 to U+009F are two bytes.
  if (lead == 0xC2) return static_cast<unsigned char>(text[1]) <= 0x9F;
  return IsControl(lead) && lead != '\t' && lead != '\n' && lead != '\r';
}

/// Eight bytes of a text at once.
class Block {
 public:
  static constexpr std::size_t kBytes = sizeof(std::uint64_t);

  explicit Block(const char* text) { std::memcpy(&bytes_, text, kBytes); }

  /// All are printable ASCII: most blocks of most texts are.
  [[nodiscard]] bool IsPrintable() const {
    return ((bytes_ | (bytes_ + kOnes) | ~(bytes_ + 0x60 * kOnes)) & kHighBits) == 0;
  }
  [[nodiscard]] bool IsAscii() const { return (bytes_ & kHighBits) == 0; }

  // Of ASCII alone: no sum of a byte then carries into the next one.
  [[nodiscard]] bool HasNul() const { return Equal(0) != 0; }
  /// Control characters that a text goes without.
  [[nodiscard]] std::size_t Controls() const {
    const std::uint64_t below_blank = ~(bytes_ + 0x60 * kOnes) & kHighBits;
    const std::uint64_t kept = Equal('\t') | Equal('\n') | Equal('\r');
    return static_cast<std::size_t>(std::popcount((below_blank & ~kept) | Equal(0x7F)));
  }

 private:
  static constexpr std::uint64_t kOnes = 0x0101'0101'0101'0101U;
  static constexpr std::uint64_t kHighBits = 0x80 * kOnes;

  /// The high bit of each byte that is `byte`.
  [[nodiscard]] std::uint64_t Equal(unsigned char byte) const {
    return ~((bytes_ ^ (byte * kOnes)) + 0x7F * kOnes) & kHighBits;
  }

  std::uint64_t bytes_ = 0;
};

/// The text behind its leading blocks of printable ASCII: most texts are only that.
std::string_view SkipPrintable(std::string_view text) {
  std::size_t at = 0;
  while (at + Block::kBytes <= text.size() && Block(text.data() + at).IsPrintable()) {
    at += Block::kBytes;
  }
  return text.substr(at);
}

/// The well-formed code point that begins there changes how a terminal shows what follows: a
/// control of C1 (U+0080 to U+009F), a mark of direction (U+200E, U+200F, U+202A to U+202E, U+2066
/// to U+2069, U+061C), or another end of line (U+2028, U+2029).
bool Steers(std::string_view text) {
  const auto at = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  if (at(0) == 0xC2) return at(1) <= 0x9F;
  if (at(0) == 0xD8) return at(1) == 0x9C;
  if (at(0) != 0xE2) return false;
  if (at(1) == 0x80) return at(2) == 0x8E || at(2) == 0x8F || (at(2) >= 0xA8 && at(2) <= 0xAE);
  return at(1) == 0x81 && at(2) >= 0xA6 && at(2) <= 0xA9;
}

}  // namespace

std::optional<std::size_t> CountControls(std::string_view text) {
  std::size_t controls = 0;
  while (true) {
    text = SkipPrintable(text);
    if (text.empty()) return controls;
    const char* block_end = text.data() + text.size();
    if (text.size() >= Block::kBytes) {
      block_end = text.data() + Block::kBytes;
      if (const Block block(text.data()); block.IsAscii()) {
        if (block.HasNul()) return std::nullopt;
        controls += block.Controls();
        text.remove_prefix(Block::kBytes);
        continue;
      }
    }
    // By code points, until blocks can be tried again.
    while (text.data() < block_end) {
      const std::size_t bytes = text.front() == '\0' ? 0 : CodePointBytes(text);
      if (bytes == 0) return std::nullopt;
      controls += IsReplaced(text) ? 1U : 0U;
      text.remove_prefix(bytes);
    }
  }
}

std::string ReplaceControls(std::string_view text, std::size_t controls) {
  static constexpr std::string_view kReplacement = "\uFFFD";
  static_assert(kReplacement.size() == kReplacementBytes);
  std::string out;
  // A control character has one byte at least.
  out.reserve(text.size() + controls * (kReplacementBytes - 1));
  while (!text.empty()) {
    const std::size_t bytes = CodePointBytes(text);
    out.append(IsReplaced(text) ? kReplacement : text.substr(0, bytes));
    text.remove_prefix(bytes);
  }
  return out;
}

std::string_view Utf8Prefix(std::string_view text, std::size_t bytes_max) {
  if (text.size() <= bytes_max) return text;
  std::size_t end = bytes_max;
  while (end > 0 && IsContinuation(static_cast<unsigned char>(text[end]))) --end;
  return text.substr(0, end);
}

std::string PrintableUtf8(std::string_view text, std::size_t bytes_max) {
  static constexpr char kHex[] = "0123456789abcdef";
  std::string out;
  while (!text.empty()) {
    const auto byte = static_cast<unsigned char>(text.front());
    const std::size_t bytes = IsControl(byte) ? 0 : CodePointBytes(text);
    if (bytes == 0 || Steers(text)) {
      if (out.size() + 4 > bytes_max) break;
      out += {'\\', 'x', kHex[byte >> 4U], kHex[byte & 0xFU]};
      text.remove_prefix(1);
    } else {
      if (out.size() + bytes > bytes_max) break;
      out.append(text.substr(0, bytes));
      text.remove_prefix(bytes);
    }
  }
  return out;
}

}  // namespace uplink
