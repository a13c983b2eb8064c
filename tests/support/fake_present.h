#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "schema/base/clock.h"
#include "storage/expiry.h"

namespace uplink::testing {

/// A row with its place: its list runs by `at`, then by `entry`, which no two rows share.
template <typename Row>
struct FakeEntry {
  SystemTime at;
  std::uint64_t entry = 0;
  Row row;
};

/// The places of the oldest entries before `until`, at most `rows_max`, ascending.
template <typename Row>
std::vector<std::pair<SystemTime, std::uint64_t>> OldestBefore(
    const std::vector<FakeEntry<Row>>& entries, SystemTime until, std::size_t rows_max) {
  std::vector<std::pair<SystemTime, std::uint64_t>> old;
  for (const FakeEntry<Row>& entry : entries) {
    if (entry.at < until) old.emplace_back(entry.at, entry.entry);
  }
  std::ranges::sort(old);
  old.resize(std::min(old.size(), rows_max));
  return old;
}

/// Deletes the oldest entries before `until`, at most `rows_max`. Returns how many.
template <typename Row>
std::size_t EraseBefore(std::vector<FakeEntry<Row>>& entries, SystemTime until,
                        std::size_t rows_max) {
  const auto old = OldestBefore(entries, until, rows_max);
  std::erase_if(entries, [&](const FakeEntry<Row>& entry) {
    return std::ranges::binary_search(old, std::pair(entry.at, entry.entry));
  });
  return old.size();
}

/// The shapes, or the objects, of all robots by id. Confined to its owner's lock.
template <typename Row>
class FakePresent final {
 public:
  using Rows = std::map<std::string, FakeEntry<Row>, std::less<>>;

  explicit FakePresent(std::size_t per_robot_max) : per_robot_max_(per_robot_max) {}

  // `now_ms`: by when an entry must have expired to be over (storage::ExpiredByMs).

  /// False if an upsert of `id` would be one more than the bound.
  [[nodiscard]] bool Takes(std::string_view ruri, std::string_view id, std::int64_t now_ms) const {
    const auto robot = robots_.find(ruri);
    if (robot == robots_.end()) return true;
    const Rows& rows = robot->second;
    return rows.size() < per_robot_max_ || rows.contains(id) ||
           std::ranges::any_of(rows, [now_ms](const auto& row) { return Expired(row, now_ms); });
  }

  /// Only if Takes. An id that is there keeps its place; one that has expired becomes a new entry.
  void Upsert(const std::string& id, FakeEntry<Row> entry, std::int64_t now_ms) {
    Rows& rows = robots_[entry.row.robot.ruri];
    const auto found = rows.find(id);
    if (found != rows.end()) {
      if (!Expired(*found, now_ms)) {
        entry.at = found->second.at;
        entry.entry = found->second.entry;
      }
      found->second = std::move(entry);
      return;
    }
    if (rows.size() >= per_robot_max_) {
      std::erase_if(rows, [now_ms](const auto& row) { return Expired(row, now_ms); });
    }
    rows.emplace(id, std::move(entry));
  }

  void Delete(std::string_view ruri, std::string_view id) {
    const auto robot = robots_.find(ruri);
    if (robot == robots_.end()) return;
    const auto found = robot->second.find(id);
    if (found != robot->second.end()) robot->second.erase(found);
  }

  /// Deletes the longest expired of those that were so at `then`. Returns how many.
  std::size_t Sweep(std::int64_t then, std::size_t rows_max) {
    std::vector<std::tuple<std::int64_t, std::string, std::string>> expired;
    for (const auto& [ruri, rows] : robots_) {
      for (const auto& row : rows) {
        if (Expired(row, then)) expired.emplace_back(row.second.row.expires_at_ms, ruri, row.first);
      }
    }
    std::ranges::sort(expired);
    expired.resize(std::min(expired.size(), rows_max));
    for (const auto& [at, ruri, id] : expired) Delete(ruri, id);
    return expired.size();
  }

  [[nodiscard]] const std::map<std::string, Rows, std::less<>>& robots() const { return robots_; }

 private:
  static bool Expired(const typename Rows::value_type& row, std::int64_t now_ms) {
    return storage::IsExpired(row.second.row.expires_at_ms, now_ms);
  }

  const std::size_t per_robot_max_;
  std::map<std::string, Rows, std::less<>> robots_;
};

}  // namespace uplink::testing
