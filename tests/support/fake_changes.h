#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <string>
#include <utility>

#include "storage/shared_items.h"

namespace uplink::testing {

/// The changes of shared items, as a FakeDatabase notes them. Confined to its lock.
class FakeChanges final {
 public:
  struct Row {
    std::uint64_t number = 0;
    storage::ItemKey key;
  };

  void Note(storage::ItemKey key) { rows_.push_back({++last_, std::move(key)}); }
  /// As storage::Store::Sweep. Returns how many went.
  std::size_t Sweep() {
    std::size_t swept = 0;
    for (; swept < storage::kChangesSweptMax && rows_.size() > storage::kChangesKept; ++swept) {
      rows_.pop_front();
    }
    return swept;
  }

  [[nodiscard]] std::uint64_t last() const { return last_; }
  /// Ascending.
  [[nodiscard]] const std::deque<Row>& rows() const { return rows_; }

 private:
  std::uint64_t last_ = 0;
  std::deque<Row> rows_;
};

}  // namespace uplink::testing
