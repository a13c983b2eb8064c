#include "server/config/removed.h"

#include <algorithm>
#include <array>

namespace uplink::config {
namespace {

constexpr auto kRemoved = std::to_array<Removed>({
    {.section = "listen",
     .key = "transport",
     .variable = "UPLINKD_LISTEN_TRANSPORT",
     .text = "removed; there is only one transport now"},
});

template <typename Predicate>
const Removed* Find(Predicate predicate) {
  const auto* const found = std::ranges::find_if(kRemoved, predicate);
  return found == kRemoved.end() ? nullptr : found;
}

}  // namespace

const Removed* FindRemoved(std::string_view section, std::string_view key) {
  return Find([&](const Removed& each) { return each.section == section && each.key == key; });
}

const Removed* FindRemovedByEnvironment(std::string_view variable) {
  return Find([&](const Removed& each) { return each.variable == variable; });
}

}  // namespace uplink::config
