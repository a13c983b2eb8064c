#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <initializer_list>
#include <map>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "schema/base/clock.h"
#include "storage/expiry.h"
#include "storage/present.h"
#include "storage/shared_items.h"

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

/// The changes of shared items, as a FakeDatabase notes them. Confined to its lock.
class FakeChanges final {
 public:
  struct Row {
    std::uint64_t number = 0;
    storage::ItemKey key;
  };

  void Note(storage::ItemKey key) { rows_.push_back({++last_, std::move(key)}); }
  /// As storage::Store::Sweep. Returns how many went.
  std::size_t Sweep() {
    std::size_t swept = 0;
    for (; swept < storage::kChangesSweptMax && rows_.size() > storage::kChangesKept; ++swept) {
      rows_.pop_front();
    }
    return swept;
  }

  [[nodiscard]] std::uint64_t last() const { return last_; }
  /// Ascending.
  [[nodiscard]] const std::deque<Row>& rows() const { return rows_; }

 private:
  std::uint64_t last_ = 0;
  std::deque<Row> rows_;
};

/// The shapes, or the objects, of all robots by id; notes what changes of those that are shared.
/// Confined to its owner's lock.
template <typename Row>
class FakePresent final {
 public:
  using Rows = std::map<std::string, FakeEntry<Row>, std::less<>>;

  /// `changes` must outlive this.
  FakePresent(storage::PresentKind kind, FakeChanges& changes)
      : kind_(kind), per_robot_max_(storage::BoundOf(kind).entries_max), changes_(changes) {}

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
    const std::string ruri = entry.row.robot.ruri;
    Rows& rows = robots_[ruri];
    const auto found = rows.find(id);
    if (found != rows.end()) {
      NoteIfShared(ruri, id, {found->second.row.scope, entry.row.scope});
      if (!Expired(*found, now_ms)) {
        entry.at = found->second.at;
        entry.entry = found->second.entry;
      }
      found->second = std::move(entry);
      return;
    }
    if (rows.size() >= per_robot_max_) DeleteExpired(ruri, now_ms);
    NoteIfShared(ruri, id, {entry.row.scope});
    rows.emplace(id, std::move(entry));
  }

  void Delete(std::string_view ruri, std::string_view id) {
    const auto robot = robots_.find(ruri);
    if (robot == robots_.end()) return;
    const auto found = robot->second.find(id);
    if (found == robot->second.end()) return;
    NoteIfShared(ruri, id, {found->second.row.scope});
    robot->second.erase(found);
  }
  /// All of a robot's.
  void DeleteAll(const std::string& ruri) {
    for (const auto& [id, entry] : robots_[ruri]) NoteIfShared(ruri, id, {entry.row.scope});
    robots_.erase(ruri);
  }

  /// The robot belongs to this fleet from now on, and what it has with it.
  void Move(const std::string& ruri, const std::string& fleet) {
    const auto robot = robots_.find(ruri);
    if (robot == robots_.end()) return;
    for (auto& [id, entry] : robot->second) {
      if (entry.row.robot.fleet == fleet) continue;
      entry.row.robot.fleet = fleet;
      NoteIfShared(ruri, id, {entry.row.scope});
    }
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
  /// Notes no change: the owner copies those too.
  void CopyRowsOf(const FakePresent& other) { robots_ = other.robots_; }

 private:
  static bool Expired(const typename Rows::value_type& row, std::int64_t now_ms) {
    return storage::IsExpired(row.second.row.expires_at_ms, now_ms);
  }

  void DeleteExpired(const std::string& ruri, std::int64_t now_ms) {
    Rows& rows = robots_[ruri];
    for (auto row = rows.begin(); row != rows.end();) {
      if (!Expired(*row, now_ms)) {
        ++row;
        continue;
      }
      NoteIfShared(ruri, row->first, {row->second.row.scope});
      row = rows.erase(row);
    }
  }
  /// `scopes`: before and after.
  void NoteIfShared(std::string_view ruri, std::string_view id,
                    std::initializer_list<model::ScopeType> scopes) {
    if (!std::ranges::any_of(scopes, storage::IsShared)) return;
    changes_.Note({kind_, std::string(ruri), std::string(id)});
  }

  const storage::PresentKind kind_;
  const std::size_t per_robot_max_;
  FakeChanges& changes_;
  std::map<std::string, Rows, std::less<>> robots_;
};

}  // namespace uplink::testing
