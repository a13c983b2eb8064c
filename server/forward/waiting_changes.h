#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <unordered_map>
#include <utility>

#include "server/forward/item.h"
#include "server/forward/limits.h"

namespace uplink::forward {

/// The changes that wait for one receiver, the latest of each item. The robots that reported them
/// take turns by bytes, so that one that shares much does not delay the others. The items of one
/// robot go in the order of their first change. Confined to its owner's lock.
///
/// The turns are start-time fair queueing: each robot has a time that advances by the bytes taken
/// from it, and the lowest is next.
class WaitingChanges final {
 public:
  /// At most `items_max` items wait.
  explicit WaitingChanges(std::size_t items_max = kWaitingMax) : items_max_(items_max) {}
  WaitingChanges(const WaitingChanges&) = delete;
  WaitingChanges& operator=(const WaitingChanges&) = delete;

  enum class Added : std::uint8_t {
    kNew,
    /// It replaced an earlier change of the item.
    kCoalesced,
    /// The item came and went while the change waited: the receiver gets neither.
    kCancelled,
    /// Too many items wait: nothing was added.
    kFull,
  };
  /// Which waiting changes to take.
  enum class Which : std::uint8_t {
    kAll,
    /// Those that a snapshot may hold: items, not deletions.
    kUpserts,
  };
  [[nodiscard]] Added Add(const KeyRef& key, const EncodedFrame& frame, Change change);
  /// The next frame; null if there is none.
  [[nodiscard]] EncodedFrame First(Which which) const;
  /// Removes the next one, which must exist.
  void Pop(Which which);
  void Clear();
  [[nodiscard]] std::size_t size() const { return places_.size(); }
  /// The robot from which most items wait; empty if none does.
  [[nodiscard]] std::string MostFrom() const;

 private:
  struct Entry {
    KeyRef key;
    EncodedFrame frame;
    /// The receiver had the item before these changes.
    bool told = false;
  };
  /// By the order of each item's first change.
  using Entries = std::map<std::uint64_t, Entry>;
  /// The robot's time, and a number that orders equal times.
  using Turn = std::pair<std::uint64_t, std::uint64_t>;
  struct Origin {
    Turn turn;
    Entries upserts;
    Entries ends;

    [[nodiscard]] Entries& Of(bool end) { return end ? ends : upserts; }
    [[nodiscard]] const Entries& FirstOf(Which which) const;
    [[nodiscard]] std::size_t size() const { return upserts.size() + ends.size(); }
  };
  using Origins = std::unordered_map<std::string, Origin>;
  using Turns = std::map<Turn, Origin*>;
  struct Place {
    Origin* origin = nullptr;
    std::uint64_t number = 0;
    bool ends = false;
  };
  [[nodiscard]] const Turns& TurnsOf(Which which) const {
    return which == Which::kAll ? turns_ : upsert_turns_;
  }
  /// Puts the robot's turn into the lists where it belongs.
  void Enlist(Origin& origin);
  /// Updates the robot's turn after something of it was taken.
  void Settle(const std::string& ruri, Origin& origin);

  const std::size_t items_max_;
  std::uint64_t next_ = 0;
  /// The time of the robot whose turn was last.
  std::uint64_t now_ = 0;
  Origins origins_;
  /// Turns of all robots, and of those with upserts.
  Turns turns_;
  Turns upsert_turns_;
  std::unordered_map<KeyRef, Place, KeyHash, KeyEqual> places_;
};

}  // namespace uplink::forward
