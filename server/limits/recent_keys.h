#pragma once

#include <cstddef>
#include <list>
#include <map>
#include <utility>

namespace uplink::limits {

/// A value for each key that was touched lately. Past `kKeysMax` keys it forgets the least recently
/// touched one: invented keys take no more memory, and the next key still has room. It is a map,
/// not a hash table: senders choose their keys, and a map has no bad case.
///
/// Limits:  kKeysMax, at least 1; each call is O(log kKeysMax). A key of 16 bytes with a time
///          takes about 112 bytes, in two nodes.
/// Thread:  confined to its owner.
template <typename Key, typename Value, std::size_t kKeysMax>
class RecentKeys final {
 public:
  /// The key's value, created if there is none; the key is now the most recent one. The reference
  /// is valid until the key is forgotten.
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
  /// Forgets keys, the least recent first, up to the first whose value is not `done`.
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
