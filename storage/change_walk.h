#pragma once

#include <cstddef>
#include <map>
#include <set>

#include "schema/base/clock.h"
#include "storage/shared_items.h"

namespace uplink::storage {

/// Makes the answer of SharedItems::ChangesSince of what a store read: the changes after the
/// positions, of each writer in the order of their numbers. Finds out what went before it was read.
///
/// Thread: as a value.
class ChangeWalk final {
 public:
  /// `last`: the last change of each writer that the store has, as read before the changes, and the
  /// time by the store's clock.
  ChangeWalk(const ChangePositions& from, ChangePositions last);

  /// The next change.
  void Take(const WriterId& writer, const ChangePosition& change, ItemKey key);
  [[nodiscard]] SharedChanges Finish() &&;

 private:
  const ChangePositions last_;
  SharedChanges changes_;
  std::set<ItemKey> seen_;
  std::size_t taken_ = 0;
};

}  // namespace uplink::storage
