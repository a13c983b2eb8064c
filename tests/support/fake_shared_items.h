#pragma once

#include <optional>
#include <span>
#include <vector>

#include "storage/shared_items.h"
#include "tests/support/fake_database.h"

namespace uplink::testing {

/// The shared items of a FakeDatabase. All changes have one writer. Thread: as
/// storage::SharedItems; SetAway from the same.
class FakeSharedItems final : public storage::SharedItems {
 public:
  /// `database` must outlive this.
  explicit FakeSharedItems(const FakeDatabase& database) : database_(database) {}

  /// Every call fails until false.
  void SetAway(bool away) { away_ = away; }

  [[nodiscard]] absl::StatusOr<storage::ChangePositions> Positions() override;
  [[nodiscard]] absl::StatusOr<storage::SharedChanges> ChangesSince(
      const storage::ChangePositions& positions) override;
  [[nodiscard]] absl::StatusOr<storage::SharedPage> Page(
      const std::optional<storage::ItemKey>& after) override;
  [[nodiscard]] absl::StatusOr<std::vector<storage::SharedItem>> Of(
      std::span<const storage::ItemKey> keys) override;

 private:
  const FakeDatabase& database_;
  bool away_ = false;
};

}  // namespace uplink::testing
