#pragma once

#include <cstddef>

#include <absl/status/status.h>

#include "tools/uplinkctl/ask/api.h"
#include "tools/uplinkctl/verbs/list_verb.h"

namespace uplink::ctl {

/// How far before the newest row --follow looks again: the store may commit a row after one that
/// arrived later.
inline constexpr milliseconds kFollowOverlap = std::chrono::seconds(10);
/// Rows that it takes over at each look.
inline constexpr std::size_t kFollowRowsMax = 10'000;

/// Whether new rows of this request come below those that are there, which stay as they are.
[[nodiscard]] bool Grows(const List& list, const Query& query);

/// Shows the rows, the newest last, and after each wait of the screen those that came meanwhile,
/// each once. JSON is a line per row. An error ends it only at the first look; later it is a note.
[[nodiscard]] absl::Status FollowRows(const List& list, const ListFlags& flags, const Query& query,
                                      Api& api, const Screen& screen);

}  // namespace uplink::ctl
