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
#include "server/forward/waiting.h"
#include "server/loop/wake.h"

namespace uplink::forward {

/// Frames that are the same for everybody.
struct SnapshotMarks {
  EncodedFrame begin;
  EncodedFrame end;
};

/// What the robots of one fleet share, and the streams that receive it: each change is put before
/// every receiver but its origin once, and a snapshot walks the shared set, so that nothing of it
/// is queued. What changes behind the walk goes between its frames, up to half of them, so that
/// less waits at its end; ends wait until then, since a snapshot holds none.
///
/// Thread: thread-safe; nothing is held across a call out.
class FleetItems final {
 public:
  /// One receiving stream. Its fields are the fleet's.
  struct Receiver {
    explicit Receiver(std::size_t waiting_max) : waiting(waiting_max) {}

    enum class State : std::uint8_t {
      /// Its next frame is SNAPSHOT_BEGIN.
      kBegins,
      /// The items behind `walked` are to come.
      kWalks,
      /// The snapshot is over: what waits are changes.
      kFollows,
    };
    std::string ruri;
    loop::StreamRef stream;
    State state = State::kBegins;
    /// The last item of the snapshot that was passed; null before the first.
    KeyRef walked;
    /// More waited than may while it walked: once that is over it begins again.
    bool again = false;
    /// It was woken, and has not looked since.
    bool woken = false;
    Waiting waiting;
    /// Its place among the receivers.
    std::size_t place = 0;
  };

  /// `whole`: its set is known already, to be empty.
  FleetItems(const SnapshotMarks& marks, bool whole, const ReceiverLimits& limits = {})
      : marks_(marks), limits_(limits), whole_(whole) {}

  /// Who is told of a change.
  struct FannedOut {
    std::vector<loop::StreamRef> to_wake;
    /// Receivers for which it waits now.
    std::size_t receivers = 0;
  };

  // --- The shared set; one thread at a time ---

  /// The item is there, or changed.
  FannedOut Put(const ItemKey& key, Item item);
  /// The item is there as before, for another time.
  void SetExpiry(const ItemKey& key, std::int64_t expires_ms);
  /// The item is there no more: `deletion` says so. Nothing if it was not.
  FannedOut Remove(const ItemKey& key, const EncodedFrame& deletion);
  /// From now on the set is whole, and snapshots may begin. Returns the streams to wake.
  std::vector<loop::StreamRef> SetWhole();

  /// The item's frame; null if it is not there.
  [[nodiscard]] EncodedFrame FrameOf(const ItemKey& key) const;
  /// Keys of items that expired at or before then, at most `most`.
  [[nodiscard]] std::vector<ItemKey> Expired(std::int64_t now_ms, std::size_t most) const;

  // --- Receivers; each on its stream's thread ---

  [[nodiscard]] std::unique_ptr<Receiver> Join(std::string ruri, loop::StreamRef stream);
  void Leave(Receiver& receiver);
  /// Adds what the receiver is to be told next, a few frames.
  void Take(Receiver& receiver, std::vector<EncodedFrame>& into);

  /// What became of changes, how many wait, and among how many.
  struct Sum {
    Counts counts;
    std::uint64_t waiting = 0;
    std::size_t items = 0;
    std::size_t receivers = 0;
    /// Receivers whose snapshot is not over, or did not begin.
    std::size_t snapshots_open = 0;
  };
  [[nodiscard]] Sum sum() const;
  /// Receivers that fell so far behind, since the last call, that they get a new snapshot, each
  /// with the robot of which most waited; the first kOverflowsToldMax.
  [[nodiscard]] std::map<std::string, std::string> TakeOverflowed();

 private:
  using Items = std::map<KeyRef, Item, KeyOrder>;
  /// What one Take may still give.
  struct Room {
    std::size_t frames;
    std::size_t bytes;

    /// False: no frame more.
    bool Give(const EncodedFrame& frame) {
      if (frames == 0 || bytes == 0) return false;
      --frames;
      bytes -= std::min(bytes, frame->size());
      return true;
    }
    /// Half of it, which is not there any more.
    Room Split() {
      const Room half{frames / 2, bytes / 2};
      frames -= half.frames;
      bytes -= half.bytes;
      return half;
    }
    /// What is left of a half.
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

  /// Puts a change before every receiver but its origin.
  FannedOut FanOut(const KeyRef& key, const EncodedFrame& frame, Change change);
  /// False: it need not wait for the receiver.
  bool Offer(Receiver& receiver, const KeyRef& key, const EncodedFrame& frame, Change change);
  void Overflow(Receiver& receiver);
  void Walk(Receiver& receiver, Room& room, std::vector<EncodedFrame>& into);
  void GiveWaiting(Receiver& receiver, Waiting::Which which, Room& room,
                   std::vector<EncodedFrame>& into);
  void SetExpiryOf(const KeyRef& key, Item& item, std::int64_t expires_ms);

  const SnapshotMarks marks_;
  const ReceiverLimits limits_;
  mutable std::mutex mutex_;
  bool whole_;
  Items items_;
  /// Of those that expire, by when.
  std::set<ExpiryOrder::Entry, ExpiryOrder> expiries_;
  std::vector<Receiver*> receivers_;
  Counts counts_;
  std::map<std::string, std::string> overflowed_;
};

}  // namespace uplink::forward
