#pragma once

#include <cstddef>
#include <utility>

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

}  // namespace uplink::storage
