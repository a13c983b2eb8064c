#pragma once

#include <cstddef>
#include <list>
#include <map>
#include <utility>

namespace uplink::limits {

/// What is known of each key that was touched lately. Past `kKeysMax` keys the one that was touched
/// least recently is forgotten: invented keys take no memory, and deny nothing to the next key. A
/// map, not a hash table: senders choose their keys, and an order has no bad case.
///
/// Limits:  kKeysMax, over 0; each call is O(log kKeysMax). A key of 16 bytes with a time takes
/// about
///          112 bytes, in two nodes.
/// Thread:  confined to its owner.
template <typename Key, typename Value, std::size_t kKeysMax>
class RecentKeys final {
 public:
  /// The key's value, made by default if there is none: from now on the most recent one. It holds
  /// until its key is forgotten.
  [[nodiscard]] Value& Touch(const Key& key) {
    const auto [place, is_new] = places_.try_emplace(key);
    if (is_new) {
      entries_.emplace_front(key, Value());
      place->second = entries_.begin();
      if (entries_.size() > kKeysMax) ForgetLast();
    } else {
      entries_.splice(entries_.begin(), entries_, place->second);
    }
    return entries_.front().second;
  }
  /// Null if the key is not known.
  [[nodiscard]] const Value* Find(const Key& key) const {
    const auto place = places_.find(key);
    return place == places_.end() ? nullptr : &place->second->second;
  }
  /// Forgets keys from the least recent on, up to the first whose value is not `done`.
  template <typename Done>
  void ForgetWhile(const Done& done) {
    while (!entries_.empty() && done(entries_.back().second)) ForgetLast();
  }
  [[nodiscard]] std::size_t size() const { return entries_.size(); }

 private:
  using Entries = std::list<std::pair<Key, Value>>;

  void ForgetLast() {
    places_.erase(entries_.back().first);
    entries_.pop_back();
  }

  /// From the most recent to the least.
  Entries entries_;
  std::map<Key, typename Entries::iterator> places_;
};

}  // namespace uplink::limits
