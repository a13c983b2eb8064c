#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace uplink::ctl {

/// Cells of a terminal that a printable text takes: none for a combining mark, two for an
/// ideograph or an emoji, one for any other character. Pure; any thread.
[[nodiscard]] std::size_t WidthOf(std::string_view text);

/// The text in at most `width` cells: a longer one ends with `…`. Pure; any thread.
[[nodiscard]] std::string CutTo(std::string_view text, std::size_t width);

}  // namespace uplink::ctl
