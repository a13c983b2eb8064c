#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace uplink::config {

/// Longest name that is compared: none of ours is longer.
inline constexpr std::size_t kNearNameBytesMax = 64;
/// Edits between a name and the one that was meant. One edit inserts, deletes or replaces a byte,
/// or swaps two neighbours.
inline constexpr std::size_t kNearEditsMax = 2;

/// The name that somebody meant who wrote `wrong`: the one with the fewest edits, the first of
/// several. Nothing if none is within kNearEditsMax edits and a third of the length of `wrong`, or
/// if `wrong` is over kNearNameBytesMax.
///
/// Thread: pure; any thread.
[[nodiscard]] std::optional<std::string> NearestName(std::string_view wrong,
                                                     std::span<const std::string> names);

/// `; did you mean NAME?`, or `otherwise` if no name is near.
[[nodiscard]] std::string DidYouMean(std::string_view wrong, std::span<const std::string> names,
                                     std::string_view otherwise);

}  // namespace uplink::config
