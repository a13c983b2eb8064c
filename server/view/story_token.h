#pragma once

#include <string>
#include <string_view>

#include <absl/status/statusor.h>

#include "server/view/story.h"
#include "storage/lists.h"

namespace uplink::view {

/// The token of the page of a story that follows this entry.
[[nodiscard]] std::string StoryToken(storage::ListOrder order, const StoryPlace& last);
/// Errors: kInvalidArgument, beginning with `pageToken`, for a text that StoryToken did not make
/// for
///         this order.
[[nodiscard]] absl::StatusOr<StoryPlace> PlaceFromToken(storage::ListOrder order,
                                                        std::string_view token);

/// The token of a list whose rows are a story's entries of kind `of`: for those that follow `after`
/// in this order. Both orders need the same entry for it: newest first kinds come backwards, too.
[[nodiscard]] std::string ListTokenAfter(storage::PageKind list, StoryKind of,
                                         storage::ListOrder order, const StoryPlace& after);

}  // namespace uplink::view
