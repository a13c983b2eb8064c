#include "server/view/parts.h"

#include <array>

namespace uplink::view {
namespace {

constexpr std::array<std::string_view, kParts> kNames = {
    "motion",     "status",    "extras",   "health",         "usage",    "consumables",
    "directives", "agentInfo", "settings", "uiCapabilities", "rcanState"};

}  // namespace

std::optional<Part> PartFromText(std::string_view text) {
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    if (kNames[i] == text) return static_cast<Part>(i);
  }
  return std::nullopt;
}

}  // namespace uplink::view
