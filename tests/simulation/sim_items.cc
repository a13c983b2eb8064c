#include "tests/simulation/sim_items.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace uplink::simulation {

using storage::ChangePositions;
using storage::ItemKey;
using storage::SharedChanges;
using storage::SharedItem;
using storage::SharedPage;

absl::Status SimItems::Begin() {
  between_();
  if (away_) return absl::UnavailableError("ordered");
  if (!fails_after_) return absl::OkStatus();
  if (*fails_after_ > 0) {
    --*fails_after_;
    return absl::OkStatus();
  }
  fails_after_.reset();
  return absl::UnavailableError("ordered");
}

absl::StatusOr<ChangePositions> SimItems::Positions() {
  if (absl::Status begun = Begin(); !begun.ok()) return begun;
  position_due_ = fault_ == ForwardFault::kPositionAfterItems;
  return items_.Positions();
}

absl::StatusOr<SharedChanges> SimItems::ChangesSince(const ChangePositions& positions) {
  if (absl::Status begun = Begin(); !begun.ok()) return begun;
  if (std::exchange(trims_, false)) return SharedChanges{.trimmed = true};
  if (std::exchange(position_due_, false)) {
    const auto late = items_.Positions();
    if (!late.ok()) return late.status();
    return items_.ChangesSince(*late);
  }
  if (fault_ == ForwardFault::kStaleLook) {
    auto all = All();
    if (!all.ok()) return all.status();
    seen_ = *std::move(all);
    between_();
  }
  auto changes = items_.ChangesSince(positions);
  if (!changes.ok() || fault_ != ForwardFault::kDeleteKept) return changes;
  if (absl::Status kept = KeepPresent(*changes); !kept.ok()) return kept;
  return changes;
}

absl::StatusOr<SharedPage> SimItems::Page(const std::optional<ItemKey>& after) {
  if (absl::Status begun = Begin(); !begun.ok()) return begun;
  auto page = items_.Page(after);
  if (page.ok() && page->items.size() > kPageMax) {
    page->items.resize(kPageMax);
    page->more = fault_ != ForwardFault::kHalfSet;
  }
  return page;
}

absl::StatusOr<std::vector<SharedItem>> SimItems::Of(std::span<const ItemKey> keys) {
  if (absl::Status begun = Begin(); !begun.ok()) return begun;
  if (fault_ != ForwardFault::kStaleLook) return items_.Of(keys);
  std::vector<SharedItem> found;
  std::ranges::copy_if(seen_, std::back_inserter(found), [keys](const SharedItem& item) {
    return std::ranges::find(keys, item.Key()) != keys.end();
  });
  return found;
}

absl::StatusOr<std::vector<SharedItem>> SimItems::All() {
  std::vector<SharedItem> all;
  std::optional<ItemKey> after;
  while (true) {
    auto page = items_.Page(after);
    if (!page.ok()) return page.status();
    std::ranges::move(page->items, std::back_inserter(all));
    if (!page->more) return all;
    after = all.back().Key();
  }
}

absl::Status SimItems::KeepPresent(SharedChanges& changes) {
  const auto present = items_.Of(changes.keys);
  if (!present.ok()) return present.status();
  std::erase_if(changes.keys, [&present](const ItemKey& key) {
    return std::ranges::none_of(*present,
                                [&key](const SharedItem& item) { return item.Key() == key; });
  });
  return absl::OkStatus();
}

}  // namespace uplink::simulation
