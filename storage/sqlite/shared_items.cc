#include "storage/shared_items.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "schema/base/check.h"
#include "storage/change_walk.h"
#include "storage/gathered_page.h"
#include "storage/read_row.h"
#include "storage/sqlite/connections.h"
#include "storage/sqlite/pages.h"
#include "storage/sqlite/parts.h"

namespace uplink::storage::sqlite {
namespace {

constexpr WriterId kOnlyWriter{};

/// The parameters: after which robot and id.
template <PageKind kList>
constexpr SqlText PageSql() {
  return {SelectSql(List<kList>::kShape, "").view(), " WHERE ", kSharedIf,
          " AND (ruri, id) > (?, ?) ORDER BY ruri, id"};
}

/// The parameters: robot and id.
template <PageKind kList>
constexpr SqlText OneSql() {
  return {SelectSql(List<kList>::kShape, "").view(), " WHERE ", kSharedIf,
          " AND ruri = ? AND id = ?"};
}

/// The statements of one list.
struct ItemStatements {
  std::unique_ptr<Statement> page, one;
};

class SqliteSharedItems final : public SharedItems {
 public:
  explicit SqliteSharedItems(std::unique_ptr<Database> database) : database_(std::move(database)) {}

  [[nodiscard]] absl::Status Prepare() {
    Preparer prepare(*database_);
    // SQLite's own note of the last number that it gave: no row has to be left.
    prepare.Into(last_, "SELECT seq FROM sqlite_sequence WHERE name = 'changes'");
    prepare.Into(since_,
                 "SELECT number, kind, origin, id FROM changes WHERE number > ?"
                 " ORDER BY number LIMIT ?");
    PrepareList<PageKind::kShapes>(prepare);
    PrepareList<PageKind::kObjects>(prepare);
    return prepare.status();
  }

  absl::StatusOr<ChangePositions> Positions() override {
    const auto last = last_->Select().First([](const Rows& row) { return NumberIn(row, 0); });
    if (!last.ok()) return last.status();
    ChangePositions positions;
    positions.writers[kOnlyWriter].number = last->value_or(0);
    return positions;
  }

  absl::StatusOr<SharedChanges> ChangesSince(const ChangePositions& positions) override {
    const absl::StatusOr<ChangePositions> last = Positions();
    if (!last.ok()) return last.status();
    ChangeWalk walk(positions, *last);
    const auto from = positions.writers.find(kOnlyWriter);
    const std::uint64_t number = from == positions.writers.end() ? 0 : from->second.number;
    Rows rows = since_->Select(number, kChangesReadMax);
    while (true) {
      const absl::StatusOr<bool> found = rows.Next();
      if (!found.ok()) return found.status();
      if (!*found) return std::move(walk).Finish();
      const std::optional<PresentKind> kind = ItemKindOf(rows.Int(1));
      if (!kind) return absl::InternalError("a change in the store is of no kind of item");
      walk.Take(kOnlyWriter, {NumberIn(rows, 0), {}}, {*kind, TextIn(rows, 2), TextIn(rows, 3)});
    }
  }

  absl::StatusOr<SharedPage> Page(const std::optional<ItemKey>& after) override {
    return GatherPage(after, [this]<PageKind kList>(const ItemKey& from, GatheredPage& gathered) {
      return Gather<kList>(from, gathered);
    });
  }

  absl::StatusOr<std::vector<SharedItem>> Of(std::span<const ItemKey> keys) override {
    std::vector<SharedItem> items;
    for (const ItemKey& key : keys) {
      if (absl::Status added = AddItem(key, items); !added.ok()) return added;
    }
    return items;
  }

 private:
  template <PageKind kList>
  ItemStatements& StatementsOf() {
    return kList == PageKind::kShapes ? shapes_ : objects_;
  }
  template <PageKind kList>
  void PrepareList(Preparer& prepare) {
    static constexpr SqlText kPage = PageSql<kList>();
    static constexpr SqlText kOne = OneSql<kList>();
    prepare.Into(StatementsOf<kList>().page, kPage.view());
    prepare.Into(StatementsOf<kList>().one, kOne.view());
  }

  /// Adds the items of one kind that come after `after`, until the page is full.
  template <PageKind kList>
  absl::Status Gather(const ItemKey& after, GatheredPage& gathered) {
    Rows rows = StatementsOf<kList>().page->Select(after.ruri, after.id);
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
  absl::Status LookUp(const ItemKey& key, std::vector<SharedItem>& items) {
    Rows rows = StatementsOf<kList>().one->Select(key.ruri, key.id);
    const absl::StatusOr<bool> found = rows.Next();
    if (!found.ok() || !*found) return found.status();
    auto row = ReadRow<kList>(rows);
    if (!row.ok()) return row.status();
    items.push_back({*std::move(row)});
    return absl::OkStatus();
  }
  absl::Status AddItem(const ItemKey& key, std::vector<SharedItem>& items) {
    switch (key.kind) {
      case PresentKind::kShape:
        return LookUp<PageKind::kShapes>(key, items);
      case PresentKind::kObject:
        return LookUp<PageKind::kObjects>(key, items);
      case PresentKind::kFault:
        break;
    }
    CheckFailed(__FILE__, __LINE__, "ItemNumberOf(key.kind)", "the key of an item");
  }

  // Destroyed in reverse: statements, then their database.
  std::unique_ptr<Database> database_;
  std::unique_ptr<Statement> last_, since_;
  ItemStatements shapes_, objects_;
};

}  // namespace

absl::StatusOr<std::unique_ptr<SharedItems>> OpenSharedItems(const std::string& path,
                                                             DamagePtr damage) {
  auto database = OpenToRead(path, kBusyTimeout, std::move(damage));
  if (!database.ok()) return database.status();
  auto items = std::make_unique<SqliteSharedItems>(*std::move(database));
  absl::Status status = items->Prepare();
  if (!status.ok()) return status;
  return items;
}

}  // namespace uplink::storage::sqlite
