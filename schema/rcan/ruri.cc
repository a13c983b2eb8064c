#include "schema/rcan/ruri.h"

#include <array>
#include <cstddef>

namespace uplink::schema {
namespace {

constexpr std::string_view kScheme = "rcan://";
constexpr std::string_view kLocal = "rcan://local.rcan/";
constexpr std::string_view kSignature = "?sig=";
constexpr std::size_t kShorthandSegments = 3;

/// The three words of a shorthand; false if it is none.
bool SplitShorthand(std::string_view text,
                    std::array<std::string_view, kShorthandSegments>& parts) {
  if (text.find_first_of("/:?") != std::string_view::npos) return false;
  for (std::size_t i = 0; i < kShorthandSegments; ++i) {
    const bool last = i + 1 == kShorthandSegments;
    const std::size_t dot = text.find('.');
    // The last word has no dot, all others end at one.
    if (last != (dot == std::string_view::npos)) return false;
    parts.at(i) = text.substr(0, dot);
    if (parts.at(i).empty()) return false;
    text.remove_prefix(last ? text.size() : dot + 1);
  }
  return true;
}

}  // namespace

std::string_view WithoutSignature(std::string_view text) {
  return text.substr(0, text.find(kSignature));
}

std::string NormalRuri(std::string_view text) {
  text = WithoutSignature(text);
  std::array<std::string_view, kShorthandSegments> parts;
  if (text.starts_with(kScheme) || !SplitShorthand(text, parts)) return std::string(text);
  std::string ruri(kLocal);
  ruri.append(parts[0]).append("/").append(parts[1]).append("/").append(parts[2]);
  return ruri;
}

}  // namespace uplink::schema
