#pragma once

#include <atomic>
#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "schema/model/presence.h"
#include "server/journal/events.h"
#include "storage/epoch.h"
#include "storage/identity.h"
#include "storage/presence.h"

namespace uplink::journal {

/// The changes of presence that are not committed. At most one per robot waits, the latest; one
/// that leads back to what was last handed over is no longer a change and does not wait.
///
/// Limits: as many entries as there are robots (limits.robots_max), which the fleet keeps; and what
///         halved batches left.
/// Thread: confined to its owner's lock; uncommitted() and CountCommitted: any thread.
class PresenceLog final {
 public:
  /// This process holds the robot since `since`, and the store has `stored` of it. Whoever judges
  /// the robot notes then what it is, if that is another.
  void Hold(const std::string& ruri, storage::Epoch since,
            const std::optional<storage::StoredPresence>& stored);
  /// Another process holds the robot, and judges it: what waits is dropped, and what was put back.
  void Lose(const std::string& ruri);

  /// The store, connected to anew, has this of the robot's presence. True if that is not what was
  /// last handed over: unless something of the robot waits, that is handed over again. What was put
  /// back goes as it is, unless the store has that presence since another time: then it is dropped.
  /// What a store that may have gone back lacks of it waits as if it was never handed over: the
  /// fleet may judge the robot anew before it is.
  bool Follow(const storage::RobotRef& robot, const std::optional<storage::StoredPresence>& stored,
              Reconnected to);

  /// A change of a robot that is not held is dropped. One that is dated before the last that was
  /// handed over, or that its former holder wrote by another clock, gets the date of that: the
  /// latest row is the one with the latest date.
  void Note(const storage::RobotRef& robot, model::Presence presence, SystemTime at);

  /// Hands over at most `items_max` changes, numbered; what was put back goes alone. Whoever takes
  /// them commits them in order, or puts them back, before it takes more.
  [[nodiscard]] std::vector<storage::PresenceItem> Take(std::size_t items_max);
  /// Taken ones, whose numbers follow each other, go ahead of those that were put back earlier.
  void PutBack(std::vector<storage::PresenceItem> items);
  /// So many of those that were taken are committed.
  void CountCommitted(std::size_t count) { uncommitted_.fetch_sub(count); }

  /// A change of the robot waits to be handed over, for the first time or again.
  [[nodiscard]] bool waits(const std::string& ruri) const;
  /// No change may be handed over for the first time.
  [[nodiscard]] bool empty() const { return waiting_.empty(); }
  /// How many changes may be handed over for the first time.
  [[nodiscard]] std::size_t size() const { return waiting_.size(); }
  /// Those that may be handed over, and those that were and are not committed yet.
  [[nodiscard]] std::size_t uncommitted() const { return uncommitted_.load(); }

 private:
  /// As Follow, of a robot whose change `put_back` is.
  bool FollowPutBack(std::vector<storage::PresenceItem>::iterator put_back,
                     const std::optional<storage::StoredPresence>& stored, Reconnected to);

  /// By RURI, so that a run repeats exactly.
  std::map<std::string, storage::PresenceItem> waiting_;
  std::unordered_map<std::string, storage::Epoch> held_;
  /// Put back, in order.
  std::vector<storage::PresenceItem> put_back_;
  /// What was last handed over, or is in the store.
  std::unordered_map<std::string, storage::StoredPresence> handed_;
  model::Seq last_number_ = 0;
  std::atomic<std::size_t> uncommitted_{0};
};

}  // namespace uplink::journal
