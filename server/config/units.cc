#include "server/config/units.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <limits>
#include <span>
#include <system_error>

#include <fmt/core.h>

namespace uplink::config {
namespace {

constexpr std::uint64_t kNumberMax = std::numeric_limits<std::int64_t>::max();

struct Unit {
  std::string_view name;
  std::uint64_t factor;
};

// Largest first, so that the shortest text is found first.
constexpr std::array<Unit, 5> kDurationUnits = {{
    {"d", 86'400'000},
    {"h", 3'600'000},
    {"m", 60'000},
    {"s", 1000},
    {"ms", 1},
}};
constexpr std::array<Unit, 4> kSizeUnits = {{
    {"GiB", 1024ULL * 1024 * 1024},
    {"MiB", 1024ULL * 1024},
    {"KiB", 1024},
    {"B", 1},
}};
constexpr std::uint64_t kDurationMsMax = 10'000 * kDurationUnits.front().factor;

std::optional<std::uint64_t> ParseWithUnit(std::string_view text, std::span<const Unit> units,
                                           std::uint64_t max) {
  const std::size_t digits = std::min(text.find_first_not_of("0123456789"), text.size());
  const std::optional<std::uint64_t> number = ParseCount(text.substr(0, digits));
  if (!number) {
    return std::nullopt;
  }
  const std::string_view name = text.substr(digits);
  if (name.empty()) {
    return *number == 0 ? number : std::nullopt;
  }
  for (const Unit& unit : units) {
    if (name == unit.name) {
      return *number <= max / unit.factor ? std::optional(*number * unit.factor) : std::nullopt;
    }
  }
  return std::nullopt;
}

std::string TextWithUnit(std::uint64_t value, std::span<const Unit> units) {
  if (value == 0) {
    return "0";
  }
  for (const Unit& unit : units) {
    if (value % unit.factor == 0) {
      return fmt::format("{}{}", value / unit.factor, unit.name);
    }
  }
  return fmt::format("{}{}", value, units.back().name);
}

}  // namespace

std::optional<std::uint64_t> ParseCount(std::string_view text) {
  std::uint64_t number = 0;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, number);
  if (text.empty() || error != std::errc() || stop != end || number > kNumberMax) {
    return std::nullopt;
  }
  return number;
}

std::optional<std::chrono::milliseconds> ParseDuration(std::string_view text) {
  const std::optional<std::uint64_t> ms = ParseWithUnit(text, kDurationUnits, kDurationMsMax);
  if (!ms) {
    return std::nullopt;
  }
  return std::chrono::milliseconds(static_cast<std::int64_t>(*ms));
}

std::optional<std::uint64_t> ParseBytes(std::string_view text) {
  return ParseWithUnit(text, kSizeUnits, kNumberMax);
}

std::string DurationText(std::chrono::milliseconds duration) {
  return TextWithUnit(static_cast<std::uint64_t>(duration.count()), kDurationUnits);
}

std::string BytesText(std::uint64_t bytes) { return TextWithUnit(bytes, kSizeUnits); }

}  // namespace uplink::config
