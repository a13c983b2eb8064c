#include "server/view/page_token.h"

#include <cstddef>
#include <cstdint>

#include "schema/model/ids.h"

namespace uplink::view {
namespace {

/// Distinguish tokens of these lists from each other, and from those of histories.
constexpr std::string_view kRobots = "r.";
constexpr std::string_view kFleets = "f.";
constexpr std::string_view kDigits = "0123456789abcdef";

std::string TokenOf(std::string_view prefix, std::string_view last) {
  std::string token(prefix);
  for (const char c : last) {
    const auto byte = static_cast<std::uint8_t>(c);
    token += kDigits[byte >> 4U];
    token += kDigits[byte & 0xFU];
  }
  return token;
}

std::optional<std::string> LastOf(std::string_view prefix, std::string_view token) {
  if (!token.starts_with(prefix)) return std::nullopt;
  const std::string_view digits = token.substr(prefix.size());
  if (digits.empty() || digits.size() % 2 != 0 || digits.size() > 2 * model::kRuriBytesMax) {
    return std::nullopt;
  }
  std::string last;
  for (std::size_t i = 0; i < digits.size(); i += 2) {
    const std::size_t high = kDigits.find(digits[i]);
    const std::size_t low = kDigits.find(digits[i + 1]);
    if (high == std::string_view::npos || low == std::string_view::npos) return std::nullopt;
    last += static_cast<char>(high << 4U | low);
  }
  return last;
}

}  // namespace

std::string RobotsToken(std::string_view last_ruri) { return TokenOf(kRobots, last_ruri); }

std::optional<std::string> RuriFromToken(std::string_view token) { return LastOf(kRobots, token); }

std::string FleetsToken(std::string_view last_fleet) { return TokenOf(kFleets, last_fleet); }

std::optional<std::string> FleetFromToken(std::string_view token) { return LastOf(kFleets, token); }

}  // namespace uplink::view
