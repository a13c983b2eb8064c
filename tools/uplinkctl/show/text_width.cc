#include "tools/uplinkctl/show/text_width.h"

#include <algorithm>
#include <array>
#include <cstdint>

namespace uplink::ctl {
namespace {

struct CodePoints {
  std::uint32_t first = 0;
  std::uint32_t last = 0;
};

/// Source: Unicode's EastAsianWidth.txt (W, F), in blocks, with the pictures that terminals draw
/// over two cells.
constexpr std::array kWide = {
    CodePoints{0x1100, 0x115F}, CodePoints{0x2E80, 0xA4CF},   CodePoints{0xAC00, 0xD7A3},
    CodePoints{0xF900, 0xFAFF}, CodePoints{0xFE30, 0xFE6F},   CodePoints{0xFF00, 0xFF60},
    CodePoints{0xFFE0, 0xFFE6}, CodePoints{0x1F300, 0x1FAFF}, CodePoints{0x20000, 0x3FFFD}};
/// Marks that stand on the character before them.
constexpr std::array kNone = {CodePoints{0x0300, 0x036F}, CodePoints{0x200B, 0x200D},
                              CodePoints{0x20D0, 0x20FF}, CodePoints{0xFE00, 0xFE0F}};

template <std::size_t N>
bool IsIn(const std::array<CodePoints, N>& ranges, std::uint32_t code) {
  return std::ranges::any_of(
      ranges, [code](const CodePoints& each) { return code >= each.first && code <= each.last; });
}

/// The bytes of the character that begins the text, which is well-formed UTF-8.
std::size_t BytesOfFirst(std::string_view text) {
  std::size_t bytes = 1;
  while (bytes < text.size() && (static_cast<unsigned char>(text[bytes]) & 0xC0U) == 0x80U) ++bytes;
  return bytes;
}

std::size_t WidthOfCharacter(std::string_view character) {
  const auto lead = static_cast<unsigned char>(character.front());
  if (character.size() == 1) return 1;
  std::uint32_t code = lead & (0xFFU >> (character.size() + 1));
  for (const char c : character.substr(1)) {
    code = code << 6U | (static_cast<unsigned char>(c) & 0x3FU);
  }
  if (IsIn(kNone, code)) return 0;
  return IsIn(kWide, code) ? 2 : 1;
}

}  // namespace

std::size_t WidthOf(std::string_view text) {
  std::size_t width = 0;
  while (!text.empty()) {
    const std::size_t bytes = BytesOfFirst(text);
    width += WidthOfCharacter(text.substr(0, bytes));
    text.remove_prefix(bytes);
  }
  return width;
}

std::string CutTo(std::string_view text, std::size_t width) {
  if (WidthOf(text) <= width) return std::string(text);
  if (width == 0) return {};
  std::string_view rest = text;
  std::size_t taken = 0;
  while (!rest.empty()) {
    const std::size_t bytes = BytesOfFirst(rest);
    taken += WidthOfCharacter(rest.substr(0, bytes));
    // One cell is for the mark of the cut.
    if (taken > width - 1) break;
    rest.remove_prefix(bytes);
  }
  return std::string(text.substr(0, text.size() - rest.size())) + "…";
}

}  // namespace uplink::ctl
