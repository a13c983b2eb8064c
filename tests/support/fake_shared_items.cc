#include "tests/support/fake_shared_items.h"

#include <mutex>
#include <utility>

#include "schema/base/check.h"
#include "storage/change_walk.h"
#include "storage/gathered_page.h"
#include "tests/support/fake_page.h"

namespace uplink::testing {
namespace {

using storage::ChangePositions;
using storage::ItemKey;
using storage::SharedItem;

constexpr storage::WriterId kOnlyWriter{};

absl::Status Away() { return absl::UnavailableError("the test said so"); }

ChangePositions LastOf(const FakeChanges& changes) {
  ChangePositions last;
  last.writers[kOnlyWriter].number = changes.last();
  return last;
}

/// Adds the items after `after`, until the page is full.
template <typename Row>
void Gather(const FakePresent<Row>& present, const ItemKey& after,
            storage::GatheredPage& gathered) {
  for (const auto& [ruri, rows] : present.robots()) {
    for (const auto& [id, entry] : rows) {
      if (!storage::IsShared(entry.row.scope)) continue;
      if (std::pair(ruri, id) <= std::pair(after.ruri, after.id)) continue;
      if (gathered.full()) {
        gathered.page.more = true;
        return;
      }
      gathered.Add({entry.row}, BytesOf(entry.row));
    }
  }
}

/// Adds the item if it is there.
template <typename Row>
void LookUp(const FakePresent<Row>& present, const ItemKey& key, std::vector<SharedItem>& items) {
  const auto robot = present.robots().find(key.ruri);
  if (robot == present.robots().end()) return;
  const auto found = robot->second.find(key.id);
  if (found == robot->second.end() || !storage::IsShared(found->second.row.scope)) return;
  items.push_back({found->second.row});
}

/// Adds the item if it is there.
void AddItem(const FakeKinds& kinds, const ItemKey& key, std::vector<SharedItem>& items) {
  switch (key.kind) {
    case storage::PresentKind::kShape:
      return LookUp(kinds.shapes(), key, items);
    case storage::PresentKind::kObject:
      return LookUp(kinds.objects(), key, items);
    case storage::PresentKind::kFault:
      UPLINK_CHECK(false, "the key of an item");
  }
}

}  // namespace

absl::StatusOr<ChangePositions> FakeSharedItems::Positions() {
  if (away_) return Away();
  const std::lock_guard lock(database_.mutex_);
  return LastOf(database_.kinds_.changes());
}

absl::StatusOr<storage::SharedChanges> FakeSharedItems::ChangesSince(
    const ChangePositions& positions) {
  if (away_) return Away();
  const std::lock_guard lock(database_.mutex_);
  const FakeChanges& changes = database_.kinds_.changes();
  storage::ChangeWalk walk(positions, LastOf(changes));
  const auto from = positions.writers.find(kOnlyWriter);
  const std::uint64_t number = from == positions.writers.end() ? 0 : from->second.number;
  std::size_t taken = 0;
  for (const FakeChanges::Row& row : changes.rows()) {
    if (row.number <= number) continue;
    if (taken++ == storage::kChangesReadMax) break;
    walk.Take(kOnlyWriter, {row.number, {}}, row.key);
  }
  return std::move(walk).Finish();
}

absl::StatusOr<storage::SharedPage> FakeSharedItems::Page(const std::optional<ItemKey>& after) {
  if (away_) return Away();
  const std::lock_guard lock(database_.mutex_);
  ItemKey start = after.value_or(ItemKey{});
  storage::GatheredPage gathered;
  // Each kind goes on with the next one, from its beginning.
  switch (start.kind) {
    case storage::PresentKind::kShape:
      Gather(database_.kinds_.shapes(), start, gathered);
      if (gathered.page.more) break;
      start = {};
      [[fallthrough]];
    case storage::PresentKind::kObject:
      Gather(database_.kinds_.objects(), start, gathered);
      break;
    case storage::PresentKind::kFault:
      UPLINK_CHECK(false, "the key of an item");
  }
  return std::move(gathered.page);
}

absl::StatusOr<std::vector<SharedItem>> FakeSharedItems::Of(std::span<const ItemKey> keys) {
  if (away_) return Away();
  const std::lock_guard lock(database_.mutex_);
  std::vector<SharedItem> items;
  for (const ItemKey& key : keys) AddItem(database_.kinds_, key, items);
  return items;
}

}  // namespace uplink::testing
