#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace uplink::storage {

/// Fleets that one query names at most: each is a search of its own in an index.
inline constexpr std::size_t kFleetsMax = 32;

/// Whether a question about `fleets` looks at this one: it is one of them, or none is named.
[[nodiscard]] inline bool LooksAt(std::span<const std::string> fleets, std::string_view fleet) {
  return fleets.empty() || std::ranges::find(fleets, fleet) != fleets.end();
}

}  // namespace uplink::storage
