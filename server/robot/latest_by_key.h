#pragma once

#include <cstddef>
#include <iterator>
#include <list>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>

namespace uplink::robot {

/// The latest value of each key, at most `kMax`; the least recently updated is evicted first. A
/// value.
template <typename Value, std::size_t kMax>
class LatestByKey {
 public:
  using Items = std::list<std::pair<std::string, Value>>;

  LatestByKey() = default;
  LatestByKey(const LatestByKey& other) : items_(other.items_) { Index(); }
  LatestByKey& operator=(const LatestByKey& other) {
    if (this != &other) {
      items_ = other.items_;
      Index();
    }
    return *this;
  }
  LatestByKey(LatestByKey&&) noexcept = default;
  LatestByKey& operator=(LatestByKey&&) noexcept = default;
  ~LatestByKey() = default;

  /// Returns the number of evicted keys (0 or 1).
  std::size_t Put(std::string key, Value value) {
    if (const auto found = index_.find(key); found != index_.end()) {
      found->second->second = std::move(value);
      items_.splice(items_.end(), items_, found->second);
      return 0;
    }
    items_.emplace_back(std::move(key), std::move(value));
    index_.emplace(items_.back().first, std::prev(items_.end()));
    if (items_.size() <= kMax) return 0;
    index_.erase(items_.front().first);
    items_.pop_front();
    return 1;
  }

  void Erase(std::string_view key) {
    const auto found = index_.find(key);
    if (found == index_.end()) return;
    const auto item = found->second;
    index_.erase(found);
    items_.erase(item);
  }

  /// Adds older values below these, as many as there is room for.
  void PutOnTopOf(LatestByKey older) {
    for (auto& [key, value] : items_) older.Put(key, std::move(value));
    *this = std::move(older);
  }

  /// Null if the key is not kept.
  [[nodiscard]] const Value* Find(std::string_view key) const {
    const auto* item = FindItem(key);
    return item == nullptr ? nullptr : &item->second;
  }
  /// As Find, with the kept key.
  [[nodiscard]] const typename Items::value_type* FindItem(std::string_view key) const {
    const auto found = index_.find(key);
    return found == index_.end() ? nullptr : &*found->second;
  }

  /// Least recently updated first.
  [[nodiscard]] const Items& items() const { return items_; }

 private:
  void Index() {
    index_.clear();
    for (auto it = items_.begin(); it != items_.end(); ++it) index_.emplace(it->first, it);
  }

  Items items_;
  // Keys are views of the list's own strings, which do not move.
  std::unordered_map<std::string_view, typename Items::iterator> index_;
};

}  // namespace uplink::robot
