#pragma once

#include <cstddef>
#include <optional>
#include <utility>

#include <absl/status/statusor.h>

#include "schema/base/check.h"
#include "storage/reader.h"
#include "storage/shared_items.h"

namespace uplink::storage {

/// A page of shared items that is being read. A value.
struct GatheredPage {
  SharedPage page;
  /// Of all texts.
  std::size_t bytes = 0;

  [[nodiscard]] bool full() const {
    return page.items.size() >= kSharedPageMax || bytes >= kPageBytesMax;
  }
  void Add(SharedItem item, std::size_t item_bytes) {
    page.items.push_back(std::move(item));
    bytes += item_bytes;
  }
};

/// The page after that item: shapes, then objects. `gather` is a template over the list: it adds
/// what comes after a key, until the page is full.
template <typename Gather>
[[nodiscard]] absl::StatusOr<SharedPage> GatherPage(const std::optional<ItemKey>& after,
                                                    const Gather& gather) {
  ItemKey start = after.value_or(ItemKey{});
  UPLINK_CHECK(ItemNumberOf(start.kind).has_value(), "the key of an item");
  GatheredPage gathered;
  absl::Status read;
  if (start.kind == PresentKind::kShape) {
    read = gather.template operator()<PageKind::kShapes>(start, gathered);
    start = {};
  }
  if (read.ok() && !gathered.page.more) {
    read = gather.template operator()<PageKind::kObjects>(start, gathered);
  }
  if (!read.ok()) return read;
  return std::move(gathered.page);
}

}  // namespace uplink::storage
