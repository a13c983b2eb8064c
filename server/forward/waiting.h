#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
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
  /// What is asked for of what waits.
  enum class Which : std::uint8_t {
    kAll,
    /// What a snapshot may hold: items as they are, and no ends.
    kUpserts,
  };
  [[nodiscard]] Added Add(const KeyRef& key, const EncodedFrame& frame, Change change);
  /// The first of them; null if there is none.
  [[nodiscard]] EncodedFrame First(Which which) const;
  /// Takes the first of them away; there is one.
  void Pop(Which which);
  void Clear();
  [[nodiscard]] std::size_t size() const { return places_.size(); }

 private:
  struct Entry {
    KeyRef key;
    EncodedFrame frame;
    /// The receiver was told of the item before these changes.
    bool told = false;
  };
  /// By when the first change of the item came.
  using Entries = std::map<std::uint64_t, Entry>;
  struct Place {
    std::uint64_t number = 0;
    bool ends = false;
  };
  [[nodiscard]] Entries& Of(bool ends) { return ends ? ends_ : upserts_; }
  /// Where the first of them is.
  [[nodiscard]] const Entries& FirstOf(Which which) const;

  const std::size_t items_max_;
  std::uint64_t next_ = 0;
  Entries upserts_;
  Entries ends_;
  std::unordered_map<KeyRef, Place, KeyHash, KeyEqual> places_;
};

}  // namespace uplink::forward
