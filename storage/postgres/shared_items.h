#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "storage/postgres/store.h"
#include "storage/shared_items.h"

namespace uplink::storage::postgres {

/// Shared items in a PostgreSQL database, over a connection of their own: whoever reads them keeps
/// no commit waiting.
///
/// Errors:  as in SharedItems; kUnavailable while the server is away, and every call tries again.
/// Thread:  as in SharedItems.
class PostgresSharedItems final : public SharedItems {
 public:
  /// As OwnConnection::Make.
  [[nodiscard]] static absl::StatusOr<std::unique_ptr<PostgresSharedItems>> Make(
      const StoreOptions& options, const Clock& clock);
  ~PostgresSharedItems() override;
  PostgresSharedItems(const PostgresSharedItems&) = delete;
  PostgresSharedItems& operator=(const PostgresSharedItems&) = delete;

  [[nodiscard]] absl::StatusOr<ChangePositions> Positions() override;
  [[nodiscard]] absl::StatusOr<SharedChanges> ChangesSince(
      const ChangePositions& positions) override;
  [[nodiscard]] absl::StatusOr<SharedPage> Page(const std::optional<ItemKey>& after) override;
  [[nodiscard]] absl::StatusOr<std::vector<SharedItem>> Of(std::span<const ItemKey> keys) override;

 private:
  struct Impl;
  explicit PostgresSharedItems(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace uplink::storage::postgres
