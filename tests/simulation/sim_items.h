#pragma once

#include <functional>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "storage/shared_items.h"
#include "tests/simulation/forward_fault.h"

namespace uplink::simulation {

/// Stands between the reading of the shared set and a store: lets others work between two calls,
/// cuts pages short, fails calls on order, and plants faults.
class SimItems final : public storage::SharedItems {
 public:
  /// Items of a page at most: simulated sets are small.
  static constexpr std::size_t kPageMax = 2;

  /// `items` outlives it. `between` is called before each call.
  SimItems(storage::SharedItems& items, std::function<void()> between, ForwardFault fault)
      : items_(items), between_(std::move(between)), fault_(fault) {}

  /// Every call fails until false.
  void SetAway(bool away) { away_ = away; }
  /// The call after `calls` more fails.
  void FailAfter(std::size_t calls) { fails_after_ = calls; }
  /// The next time that changes are asked for they were trimmed.
  void TrimNext() { trims_ = true; }

  [[nodiscard]] absl::StatusOr<storage::ChangePositions> Positions() override;
  [[nodiscard]] absl::StatusOr<storage::SharedChanges> ChangesSince(
      const storage::ChangePositions& positions) override;
  [[nodiscard]] absl::StatusOr<storage::SharedPage> Page(
      const std::optional<storage::ItemKey>& after) override;
  [[nodiscard]] absl::StatusOr<std::vector<storage::SharedItem>> Of(
      std::span<const storage::ItemKey> keys) override;

 private:
  absl::Status Begin();
  [[nodiscard]] absl::StatusOr<std::vector<storage::SharedItem>> All();
  /// Drops the keys of items that are gone.
  absl::Status KeepPresent(storage::SharedChanges& changes);

  storage::SharedItems& items_;
  const std::function<void()> between_;
  const ForwardFault fault_;
  bool away_ = false;
  bool trims_ = false;
  std::optional<std::size_t> fails_after_;
  /// For planted faults: the position is not taken yet; all items as they were.
  bool position_due_ = false;
  std::vector<storage::SharedItem> seen_;
};

}  // namespace uplink::simulation
