#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "schema/base/clock.h"
#include "storage/shared_items.h"

namespace uplink::forward {

/// A store of one writer, as a list of changes and what is there.
class ScriptedItems final : public storage::SharedItems {
 public:
  void Set(const storage::ItemKey& key, std::int64_t expires_ms = 0,
           const std::string& geometry = R"({"type":"Point","coordinates":[1.0,2.0]})") {
    storage::ShapeRow row;
    row.robot = {.ruri = key.ruri, .fleet = "north"};
    row.identity.id = key.id;
    row.scope = model::ScopeType::kFleet;
    row.geometry_json = geometry;
    row.expires_at_ms = expires_ms;
    there[key] = {.row = row};
    log.push_back(key);
  }
  void MoveToFleet(const storage::ItemKey& key, const std::string& fleet) {
    std::get<storage::ShapeRow>(there.at(key).row).robot.fleet = fleet;
    log.push_back(key);
  }
  void Erase(const storage::ItemKey& key) {
    there.erase(key);
    log.push_back(key);
  }

  absl::StatusOr<storage::ChangePositions> Positions() override {
    if (!status.ok()) return status;
    ++asked_for_positions;
    return At(log.size());
  }
  absl::StatusOr<storage::SharedChanges> ChangesSince(
      const storage::ChangePositions& positions) override {
    if (!status.ok()) return status;
    const auto entry = positions.writers.find({});
    const std::size_t from = entry == positions.writers.end() ? 0 : entry->second.number;
    storage::SharedChanges changes;
    if (from < trimmed_to) {
      changes.trimmed = true;
      return changes;
    }
    const std::size_t to = std::min(log.size(), from + changes_at_once);
    for (std::size_t i = from; i < to; ++i) {
      if (std::ranges::find(changes.keys, log[i]) == changes.keys.end()) {
        changes.keys.push_back(log[i]);
      }
    }
    changes.positions = At(to);
    changes.more = to < log.size();
    return changes;
  }
  absl::StatusOr<storage::SharedPage> Page(const std::optional<storage::ItemKey>& after) override {
    if (fails_at_page == pages++) return absl::UnavailableError("away within the read");
    if (at_each_page) at_each_page();
    storage::SharedPage page;
    for (const auto& [key, item] : there) {
      if (after && key <= *after) continue;
      if (page.items.size() == 2) {
        page.more = true;
        break;
      }
      page.items.push_back(item);
    }
    return page;
  }
  absl::StatusOr<std::vector<storage::SharedItem>> Of(
      std::span<const storage::ItemKey> keys) override {
    looked_up.push_back(keys.size());
    std::vector<storage::SharedItem> items;
    for (const storage::ItemKey& key : keys) {
      if (there.contains(key)) items.push_back(there.at(key));
    }
    return items;
  }

  std::map<storage::ItemKey, storage::SharedItem> there;
  std::vector<storage::ItemKey> log;
  std::size_t trimmed_to = 0;
  /// Of one answer of ChangesSince.
  std::size_t changes_at_once = 2;
  /// How many keys each call of Of named.
  std::vector<std::size_t> looked_up;
  absl::Status status;
  std::size_t pages = 0;
  std::optional<std::size_t> fails_at_page;
  std::function<void()> at_each_page;
  int asked_for_positions = 0;

 private:
  static storage::ChangePositions At(std::size_t number) {
    storage::ChangePositions positions;
    positions.writers[{}].number = number;
    return positions;
  }
};

/// The same for a test beside the thread that looks. Thread-safe.
class LockedItems final : public storage::SharedItems {
 public:
  template <typename Do>
  void With(const Do& action) {
    const std::lock_guard lock(mutex_);
    action(items_);
  }
  /// When changes were asked for, each time.
  [[nodiscard]] std::vector<SteadyTime> looks() const {
    const std::lock_guard lock(mutex_);
    return looks_;
  }

  absl::StatusOr<storage::ChangePositions> Positions() override {
    const std::lock_guard lock(mutex_);
    return items_.Positions();
  }
  absl::StatusOr<storage::SharedChanges> ChangesSince(
      const storage::ChangePositions& positions) override {
    const std::lock_guard lock(mutex_);
    auto changes = items_.ChangesSince(positions);
    // Those that follow at once belong to the same look.
    if (!changes.ok() || !changes->more) looks_.push_back(SystemClock{}.Steady());
    return changes;
  }
  absl::StatusOr<storage::SharedPage> Page(const std::optional<storage::ItemKey>& after) override {
    const std::lock_guard lock(mutex_);
    return items_.Page(after);
  }
  absl::StatusOr<std::vector<storage::SharedItem>> Of(
      std::span<const storage::ItemKey> keys) override {
    const std::lock_guard lock(mutex_);
    return items_.Of(keys);
  }

 private:
  mutable std::mutex mutex_;
  ScriptedItems items_;
  std::vector<SteadyTime> looks_;
};

}  // namespace uplink::forward
