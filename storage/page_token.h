#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include <absl/status/statusor.h>

#include "schema/base/clock.h"
#include "storage/lists.h"
#include "storage/reader.h"

namespace uplink::storage {

/// The position in a list in one order, as an opaque text of lower-case hex digits with a check
/// sum.
[[nodiscard]] std::string EncodePageToken(PageKind kind, ListOrder order,
                                          const PagePosition& position);

/// Errors: kInvalidArgument, beginning with `pageToken`, for a text that EncodePageToken did not
///         make for this list in this order.
[[nodiscard]] absl::StatusOr<PagePosition> DecodePageToken(PageKind kind, ListOrder order,
                                                           std::string_view token);

/// What every list checks of its query: where to begin (nothing: at the first row of its order).
///
/// Errors: kInvalidArgument, beginning with `pageToken`, `pageSize`, `ruri` or `fleet`.
[[nodiscard]] absl::StatusOr<std::optional<PagePosition>> PageStart(PageKind kind,
                                                                    const HistoryQuery& query);

}  // namespace uplink::storage
