#include "storage/sqlite/shared_items.h"

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

#include "schema/base/check.h"
#include "storage/change_walk.h"
#include "storage/gathered_page.h"
#include "storage/sqlite/lists.h"
#include "storage/sqlite/open_beside.h"
#include "storage/sqlite/prepare.h"

namespace uplink::storage::sqlite {
namespace {

constexpr WriterId kOnlyWriter{};

/// What ReadRow<kList> reads.
template <PageKind kList>
constexpr SqlText SelectSql() {
  return {"SELECT ",
          List<kList>::kTable.listed.time_column,
          ", entry, ruri, fleet, ",
          List<kList>::kColumns.view(),
          " FROM ",
          List<kList>::kTable.name,
          " WHERE ",
          kSharedIf};
}

/// The parameters: after which robot and id.
template <PageKind kList>
constexpr SqlText PageSql() {
  return {SelectSql<kList>().view(), " AND (ruri, id) > (?, ?) ORDER BY ruri, id"};
}

/// The parameters: robot and id.
template <PageKind kList>
constexpr SqlText OneSql() {
  return {SelectSql<kList>().view(), " AND ruri = ? AND id = ?"};
}

/// Adds the items of one kind that come after `after`, as far as there is room for them.
template <PageKind kList>
absl::Status Gather(Statement& statement, const ItemKey& after, GatheredPage& gathered) {
  Rows rows = statement.Select(std::string_view(after.ruri), std::string_view(after.id));
  while (true) {
    const absl::StatusOr<bool> found = rows.Next();
    if (!found.ok() || !*found) return found.status();
    if (gathered.full()) {
      gathered.page.more = true;
      return absl::OkStatus();
    }
    auto row = ReadRow<kList>(rows);
    if (!row.ok()) return row.status();
    gathered.Add({*std::move(row)}, rows.TextBytes());
  }
}

/// Adds the item if it is there.
template <PageKind kList>
absl::Status LookUp(Statement& statement, const ItemKey& key, std::vector<SharedItem>& items) {
  Rows rows = statement.Select(std::string_view(key.ruri), std::string_view(key.id));
  const absl::StatusOr<bool> found = rows.Next();
  if (!found.ok() || !*found) return found.status();
  auto row = ReadRow<kList>(rows);
  if (!row.ok()) return row.status();
  items.push_back({*std::move(row)});
  return absl::OkStatus();
}

}  // namespace

SqliteSharedItems::SqliteSharedItems(std::unique_ptr<Database> database)
    : database_(std::move(database)) {}

absl::StatusOr<std::unique_ptr<SqliteSharedItems>> SqliteSharedItems::Open(const std::string& path,
                                                                           DamagePtr damage) {
  auto database = OpenToRead(path, kBusyTimeout, std::move(damage));
  if (!database.ok()) return database.status();
  std::unique_ptr<SqliteSharedItems> items(new SqliteSharedItems(*std::move(database)));
  absl::Status status = items->Prepare();
  if (!status.ok()) return status;
  return items;
}

absl::Status SqliteSharedItems::Prepare() {
  static constexpr SqlText kShapes = PageSql<PageKind::kShapes>();
  static constexpr SqlText kObjects = PageSql<PageKind::kObjects>();
  static constexpr SqlText kShape = OneSql<PageKind::kShapes>();
  static constexpr SqlText kObject = OneSql<PageKind::kObjects>();
  Preparer prepare(*database_);
  // SQLite's own note of the last number that it gave: no row has to be left.
  prepare.Into(last_, "SELECT seq FROM sqlite_sequence WHERE name = 'changes'");
  prepare.Into(since_,
               "SELECT number, kind, origin, id FROM changes WHERE number > ?"
               " ORDER BY number LIMIT ?");
  prepare.Into(shapes_, kShapes.view());
  prepare.Into(objects_, kObjects.view());
  prepare.Into(shape_, kShape.view());
  prepare.Into(object_, kObject.view());
  return prepare.status();
}

absl::StatusOr<ChangePositions> SqliteSharedItems::Positions() {
  Rows rows = last_->Select();
  const absl::StatusOr<bool> found = rows.Next();
  if (!found.ok()) return found.status();
  ChangePositions positions;
  positions.writers[kOnlyWriter].number = *found ? static_cast<std::uint64_t>(rows.Int(0)) : 0;
  return positions;
}

absl::StatusOr<SharedChanges> SqliteSharedItems::ChangesSince(const ChangePositions& positions) {
  const absl::StatusOr<ChangePositions> last = Positions();
  if (!last.ok()) return last.status();
  ChangeWalk walk(positions, *last);
  const auto from = positions.writers.find(kOnlyWriter);
  const std::uint64_t number = from == positions.writers.end() ? 0 : from->second.number;
  Rows rows = since_->Select(number, static_cast<std::int64_t>(kChangesReadMax));
  while (true) {
    const absl::StatusOr<bool> found = rows.Next();
    if (!found.ok()) return found.status();
    if (!*found) return std::move(walk).Finish();
    const std::optional<PresentKind> kind = ItemKindOf(rows.Int(1));
    if (!kind) return absl::InternalError("a change in the store is of no kind of item");
    walk.Take(kOnlyWriter, {static_cast<std::uint64_t>(rows.Int(0)), {}},
              {*kind, std::string(rows.Bytes(2)), std::string(rows.Bytes(3))});
  }
}

absl::StatusOr<SharedPage> SqliteSharedItems::Page(const std::optional<ItemKey>& after) {
  ItemKey start = after.value_or(ItemKey{});
  GatheredPage gathered;
  absl::Status read;
  // Each kind goes on with the next one, from its beginning.
  switch (start.kind) {
    case PresentKind::kShape:
      read = Gather<PageKind::kShapes>(*shapes_, start, gathered);
      if (!read.ok() || gathered.page.more) break;
      start = {};
      [[fallthrough]];
    case PresentKind::kObject:
      read = Gather<PageKind::kObjects>(*objects_, start, gathered);
      break;
    case PresentKind::kFault:
      UPLINK_CHECK(false, "the key of an item");
  }
  if (!read.ok()) return read;
  return std::move(gathered.page);
}

absl::Status SqliteSharedItems::AddItem(const ItemKey& key, std::vector<SharedItem>& items) {
  switch (key.kind) {
    case PresentKind::kShape:
      return LookUp<PageKind::kShapes>(*shape_, key, items);
    case PresentKind::kObject:
      return LookUp<PageKind::kObjects>(*object_, key, items);
    case PresentKind::kFault:
      break;
  }
  CheckFailed(__FILE__, __LINE__, "ItemNumberOf(key.kind)", "the key of an item");
}

absl::StatusOr<std::vector<SharedItem>> SqliteSharedItems::Of(std::span<const ItemKey> keys) {
  std::vector<SharedItem> items;
  for (const ItemKey& key : keys) {
    if (absl::Status added = AddItem(key, items); !added.ok()) return added;
  }
  return items;
}

}  // namespace uplink::storage::sqlite
