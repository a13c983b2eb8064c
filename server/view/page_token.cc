#include "server/view/page_token.h"

#include <cstddef>
#include <cstdint>

#include "schema/model/ids.h"

namespace uplink::view {
namespace {

/// Distinguishes tokens of robots from those of histories.
constexpr std::string_view kPrefix = "r.";
constexpr std::string_view kDigits = "0123456789abcdef";

}  // namespace

std::string RobotsToken(std::string_view last_ruri) {
  std::string token(kPrefix);
  for (const char c : last_ruri) {
    const auto byte = static_cast<std::uint8_t>(c);
    token += kDigits[byte >> 4U];
    token += kDigits[byte & 0xFU];
  }
  return token;
}

std::optional<std::string> RuriFromToken(std::string_view token) {
  if (!token.starts_with(kPrefix)) return std::nullopt;
  const std::string_view digits = token.substr(kPrefix.size());
  if (digits.empty() || digits.size() % 2 != 0 || digits.size() > 2 * model::kRuriBytesMax) {
    return std::nullopt;
  }
  std::string ruri;
  for (std::size_t i = 0; i < digits.size(); i += 2) {
    const std::size_t high = kDigits.find(digits[i]);
    const std::size_t low = kDigits.find(digits[i + 1]);
    if (high == std::string_view::npos || low == std::string_view::npos) return std::nullopt;
    ruri += static_cast<char>(high << 4U | low);
  }
  return ruri;
}

}  // namespace uplink::view
