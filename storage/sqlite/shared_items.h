#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "storage/shared_items.h"
#include "storage/sqlite/database.h"
#include "storage/sqlite/statement.h"

namespace uplink::storage::sqlite {

/// Shared items in an SQLite file, over a connection of their own that only reads. All changes have
/// one writer, and no times: one transaction writes at a time.
///
/// Errors:  of Open, as OpenToRead. Of the calls, as in SharedItems.
/// Thread:  as in SharedItems.
class SqliteSharedItems final : public SharedItems {
 public:
  [[nodiscard]] static absl::StatusOr<std::unique_ptr<SqliteSharedItems>> Open(
      const std::string& path, DamagePtr damage = nullptr);
  SqliteSharedItems(const SqliteSharedItems&) = delete;
  SqliteSharedItems& operator=(const SqliteSharedItems&) = delete;

  [[nodiscard]] absl::StatusOr<ChangePositions> Positions() override;
  [[nodiscard]] absl::StatusOr<SharedChanges> ChangesSince(
      const ChangePositions& positions) override;
  [[nodiscard]] absl::StatusOr<SharedPage> Page(const std::optional<ItemKey>& after) override;
  [[nodiscard]] absl::StatusOr<std::vector<SharedItem>> Of(std::span<const ItemKey> keys) override;

 private:
  explicit SqliteSharedItems(std::unique_ptr<Database> database);
  absl::Status Prepare();
  /// Adds the item if it is there.
  absl::Status AddItem(const ItemKey& key, std::vector<SharedItem>& items);

  /// Destroyed in reverse: statements, then their database.
  std::unique_ptr<Database> database_;
  std::unique_ptr<Statement> last_, since_;
  std::unique_ptr<Statement> shapes_, objects_;
  std::unique_ptr<Statement> shape_, object_;
};

}  // namespace uplink::storage::sqlite
