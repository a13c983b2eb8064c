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

/// The changes that wait for one receiver: of each item the latest. Robots that reported them take
/// turns by bytes, so that one that shares much does not keep what others share waiting; those of
/// one robot go in the order in which each item first changed. Confined to its owner's lock.
///
/// The turns are those of start-time fair queueing: each robot has a time, which goes on by what is
/// taken of it, and the one with the lowest is next.
class Waiting final {
 public:
  /// At most `items_max` items wait.
  explicit Waiting(std::size_t items_max = kWaitingMax) : items_max_(items_max) {}
  Waiting(const Waiting&) = delete;
  Waiting& operator=(const Waiting&) = delete;

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
  /// The next of them; null if there is none.
  [[nodiscard]] EncodedFrame First(Which which) const;
  /// Takes the next of them away; there is one.
  void Pop(Which which);
  void Clear();
  [[nodiscard]] std::size_t size() const { return places_.size(); }
  /// Of which robot most items wait; empty if none does.
  [[nodiscard]] std::string MostFrom() const;

 private:
  struct Entry {
    KeyRef key;
    EncodedFrame frame;
    /// The receiver was told of the item before these changes.
    bool told = false;
  };
  /// By when the first change of the item came.
  using Entries = std::map<std::uint64_t, Entry>;
  /// The robot's time, and when it got it.
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
  /// The robot's turn is in the lists where it belongs.
  void Enlist(Origin& origin);
  /// Something of the robot went.
  void Settle(const std::string& ruri, Origin& origin);

  const std::size_t items_max_;
  std::uint64_t next_ = 0;
  /// The time of the robot whose turn was last.
  std::uint64_t now_ = 0;
  Origins origins_;
  /// Of all robots, and of those that have upserts.
  Turns turns_;
  Turns upsert_turns_;
  std::unordered_map<KeyRef, Place, KeyHash, KeyEqual> places_;
};

}  // namespace uplink::forward
