#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "server/forward/counts.h"
#include "server/forward/item.h"
#include "server/forward/limits.h"
#include "server/forward/waiting_changes.h"
#include "server/loop/wake.h"

namespace uplink::forward {

/// Frames that are the same for all receivers.
struct SnapshotMarks {
  EncodedFrame begin;
  EncodedFrame end;
};

/// The items that the robots of one fleet share, and the streams that receive them. Each change is
/// queued once for every receiver but its origin. A snapshot walks the shared set, so its items are
/// not queued. Changes behind the walk may take up to half of its frames, so that fewer wait at its
/// end. Deletions wait until then, since a snapshot holds none.
///
/// Thread: thread-safe; no lock is held across a call out.
class FleetItems final {
 public:
  /// One receiving stream. FleetItems alone uses its fields.
  struct Receiver {
    explicit Receiver(std::size_t waiting_max) : waiting(waiting_max) {}

    enum class State : std::uint8_t {
      /// Its next frame is SNAPSHOT_BEGIN.
      kBegins,
      /// Its next frames are the items behind `walked`.
      kWalks,
      /// The snapshot has ended: only changes wait.
      kFollows,
    };
    std::string ruri;
    loop::StreamRef stream;
    State state = State::kBegins;
    /// The last item that the snapshot passed; null before the first.
    KeyRef walked;
    /// Too many items waited while it walked: it begins again afterwards.
    bool again = false;
    /// It was woken, and has not looked since.
    bool woken = false;
    WaitingChanges waiting;
    /// Its index among the receivers.
    std::size_t place = 0;
  };

  /// `whole`: its set is known to be empty.
  FleetItems(const SnapshotMarks& marks, bool whole, const ReceiverLimits& limits = {})
      : marks_(marks), limits_(limits), whole_(whole) {}

  /// The receivers of a change.
  struct FannedOut {
    std::vector<loop::StreamRef> to_wake;
    /// Receivers for which it waits, and replaced no earlier change.
    std::size_t receivers = 0;
  };

  // --- The shared set; one thread at a time ---

  /// Adds or replaces the item.
  FannedOut Put(const ItemKey& key, Item item);
  /// Changes only when the item expires.
  void SetExpiry(const ItemKey& key, std::int64_t expires_ms);
  /// Removes the item, by the frame `deletion`. No effect if it was not there.
  FannedOut Remove(const ItemKey& key, const EncodedFrame& deletion);
  /// The set is complete from now on: snapshots may begin. Returns the streams to wake.
  std::vector<loop::StreamRef> SetWhole();

  /// The item's frame; null if it is not there.
  [[nodiscard]] EncodedFrame FrameOf(const ItemKey& key) const;
  /// Keys of items that expired at or before then, at most `most`.
  [[nodiscard]] std::vector<ItemKey> Expired(std::int64_t now_ms, std::size_t most) const;

  // --- Receivers; each on its stream's thread ---

  [[nodiscard]] std::unique_ptr<Receiver> Join(std::string ruri, loop::StreamRef stream);
  void Leave(Receiver& receiver);
  /// Adds the receiver's next few frames.
  void Take(Receiver& receiver, std::vector<EncodedFrame>& into);

  /// Counts of changes, and how many wait.
  struct Sum {
    Counts counts;
    std::uint64_t waiting = 0;
    std::size_t items = 0;
    std::size_t receivers = 0;
    /// Receivers whose snapshot has not begun, or not ended.
    std::size_t snapshots_open = 0;
  };
  [[nodiscard]] Sum sum() const;
  /// Receivers that fell so far behind since the last call that they get a new snapshot, each with
  /// the robot from which most items waited; the first kOverflowsToldMax.
  [[nodiscard]] std::map<std::string, std::string> TakeOverflowed();

 private:
  using Items = std::map<KeyRef, Item, KeyOrder>;
  /// What one Take may still add.
  struct Room {
    std::size_t frames;
    std::size_t bytes;

    /// False: no room for another frame.
    bool Give(const EncodedFrame& frame) {
      if (frames == 0 || bytes == 0) return false;
      --frames;
      bytes -= std::min(bytes, frame->size());
      return true;
    }
    /// Moves half of it out.
    Room Split() {
      const Room half{frames / 2, bytes / 2};
      frames -= half.frames;
      bytes -= half.bytes;
      return half;
    }
    /// Gives back the rest of a half.
    void Join(const Room& half) {
      frames += half.frames;
      bytes += half.bytes;
    }
  };
  struct ExpiryOrder {
    using Entry = std::pair<std::int64_t, KeyRef>;
    bool operator()(const Entry& a, const Entry& b) const {
      return a.first != b.first ? a.first < b.first : KeyOrder()(a.second, b.second);
    }
  };

  /// Queues a change for every receiver but its origin.
  FannedOut FanOut(const KeyRef& key, const EncodedFrame& frame, Change change);
  /// Whether the change waits for the receiver, and replaced no earlier one.
  bool Offer(Receiver& receiver, const KeyRef& key, const EncodedFrame& frame, Change change);
  void Overflow(Receiver& receiver);
  void Walk(Receiver& receiver, Room& room, std::vector<EncodedFrame>& into);
  void GiveWaiting(Receiver& receiver, WaitingChanges::Which which, Room& room,
                   std::vector<EncodedFrame>& into);
  void SetExpiryOf(const KeyRef& key, Item& item, std::int64_t expires_ms);

  const SnapshotMarks marks_;
  const ReceiverLimits limits_;
  mutable std::mutex mutex_;
  bool whole_;
  Items items_;
  /// Items that expire, by when.
  std::set<ExpiryOrder::Entry, ExpiryOrder> expiries_;
  std::vector<Receiver*> receivers_;
  Counts counts_;
  std::map<std::string, std::string> overflowed_;
};

}  // namespace uplink::forward
