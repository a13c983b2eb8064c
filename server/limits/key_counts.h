#pragma once

#include <cstddef>
#include <map>

#include "schema/base/check.h"

namespace uplink::limits {

/// How many things each key has now, so that the owner of this object can refuse one more. Keys
/// without any are forgotten: it is no larger than what it counts. Confined to its owner.
template <typename Key>
class KeyCounts final {
 public:
  [[nodiscard]] std::size_t Of(const Key& key) const {
    const auto found = counts_.find(key);
    return found == counts_.end() ? 0 : found->second;
  }
  void Add(const Key& key) { ++counts_[key]; }
  /// Undoes one Add.
  void Drop(const Key& key) {
    const auto found = counts_.find(key);
    UPLINK_CHECK(found != counts_.end(), "one goes that did not come");
    if (--found->second == 0) counts_.erase(found);
  }

 private:
  std::map<Key, std::size_t> counts_;
};

}  // namespace uplink::limits
