#include "server/identity/fleet_name.h"

#include <algorithm>
#include <cstdint>

#include <fmt/core.h>

#include "schema/base/utf8.h"
#include "server/identity/invisible_characters.h"

namespace uplink::identity {
namespace {

/// How many bytes of a wrong name a message repeats.
constexpr std::size_t kShownBytesMax = 128;

}  // namespace

std::optional<std::string> FlawOfFleet(std::string_view fleet) {
  if (fleet.empty()) return "is empty";
  if (fleet.size() > kFleetBytesMax) {
    return fmt::format("has {} bytes, the limit is {}", fleet.size(), kFleetBytesMax);
  }
  const auto is_control = [](unsigned char c) { return c < 0x20 || c == 0x7F; };
  if (std::any_of(fleet.begin(), fleet.end(), is_control)) {
    return fmt::format("holds a control character: {}", PrintableUtf8(fleet, kShownBytesMax));
  }
  return std::nullopt;
}

std::optional<std::string> FlawOfNewFleet(std::string_view fleet) {
  if (auto flaw = FlawOfFleet(fleet)) return flaw;
  const std::optional<char32_t> invisible = InvisibleCharacter(fleet);
  if (!invisible) return std::nullopt;
  return fmt::format("holds U+{:04X}, which is invisible", static_cast<std::uint32_t>(*invisible));
}

}  // namespace uplink::identity
