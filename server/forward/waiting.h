#pragma once

#include <cstddef>
#include <cstdint>
#include <list>
#include <unordered_map>

#include "server/forward/item.h"
#include "server/forward/limits.h"

namespace uplink::forward {

/// The changes that wait for one receiver: of each item the latest, in the place of the first.
/// Confined to its owner's lock.
class Waiting final {
 public:
  /// At most `items_max` items wait.
  explicit Waiting(std::size_t items_max = kWaitingMax) : items_max_(items_max) {}

  enum class Added : std::uint8_t {
    kNew,
    /// It took the place of an earlier change of the item.
    kCoalesced,
    /// The item came and went while it waited: the receiver is told of neither.
    kCancelled,
    /// As many items wait as may: nothing was added.
    kFull,
  };
  [[nodiscard]] Added Add(const KeyRef& key, const EncodedFrame& frame, Change change);
  /// The first; size() is not 0.
  [[nodiscard]] const EncodedFrame& first() const { return entries_.front().frame; }
  [[nodiscard]] EncodedFrame Take();
  void Clear();
  [[nodiscard]] std::size_t size() const { return entries_.size(); }

 private:
  struct Entry {
    KeyRef key;
    EncodedFrame frame;
    /// The receiver was told of the item before these changes.
    bool told = false;
  };
  const std::size_t items_max_;
  std::list<Entry> entries_;
  std::unordered_map<KeyRef, std::list<Entry>::iterator, KeyHash, KeyEqual> places_;
};

}  // namespace uplink::forward
