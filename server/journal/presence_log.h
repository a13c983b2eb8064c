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

/// The changes of presence, and of until when robots are parked, that are not committed. At most
/// one per robot waits, the latest. A change back to what was last handed over does not wait.
///
/// Limits: one entry per robot, which the fleet bounds (limits.robots_max), and what halved batches
///         put back.
/// Thread: confined to its owner's lock; uncommitted() and CountCommitted: any thread.
class PresenceLog final {
 public:
  /// This process holds the robot since `since`, and the store has `stored` as its presence. The
  /// robot's state then notes its presence if that differs.
  void Hold(const std::string& ruri, storage::Epoch since,
            const std::optional<storage::StoredPresence>& stored);
  /// Another process holds and judges the robot: drops its waiting change, and one that was put
  /// back.
  void Lose(const std::string& ruri);

  /// After a new connection, the store has this presence of the robot. True if it differs from what
  /// was last handed over: unless a change of the robot waits, that is handed over again. A change
  /// that was put back goes as it is, unless the store has that presence since another time: then
  /// it is dropped. A change that a store that may have gone back lacks waits as if it was never
  /// handed over, since the fleet may judge the robot anew before.
  bool Follow(const storage::RobotRef& robot, const std::optional<storage::StoredPresence>& stored,
              Reconnected to);

  /// Notes a change; dropped if the robot is not held. If it is dated before the last one that was
  /// handed over, or that a former holder wrote by another clock, it gets that date: the latest row
  /// is the one with the latest date.
  /// `why` and `parked_until` are PresenceItem's. What differs in parked_until alone changes no
  /// presence.
  void Note(const storage::RobotRef& robot, model::Presence presence, SystemTime at,
            std::optional<model::ConnectionEnd> why = {},
            std::optional<SystemTime> parked_until = {});

  /// Hands over at most `items_max` changes, numbered; changes that were put back go alone. The
  /// caller commits them in order, or puts them back, before it takes more.
  [[nodiscard]] std::vector<storage::PresenceItem> Take(std::size_t items_max);
  /// Puts back taken changes with successive numbers, ahead of those that were put back earlier.
  void PutBack(std::vector<storage::PresenceItem> items);
  /// So many taken changes are committed.
  void CountCommitted(std::size_t count) { uncommitted_.fetch_sub(count); }

  /// A change of the robot waits to be handed over, first or again.
  [[nodiscard]] bool waits(const std::string& ruri) const;
  /// No change waits to be handed over for the first time.
  [[nodiscard]] bool empty() const { return waiting_.empty(); }
  /// How many changes wait to be handed over for the first time.
  [[nodiscard]] std::size_t size() const { return waiting_.size(); }
  /// Changes that wait, and those handed over that are not committed yet.
  [[nodiscard]] std::size_t uncommitted() const { return uncommitted_.load(); }

 private:
  /// As Follow, for a robot whose change `put_back` is.
  bool FollowPutBack(std::vector<storage::PresenceItem>::iterator put_back,
                     const std::optional<storage::StoredPresence>& stored, Reconnected to);

  /// By RURI, so that a run repeats exactly.
  std::map<std::string, storage::PresenceItem> waiting_;
  std::unordered_map<std::string, storage::Epoch> held_;
  /// Changes that were put back, in order.
  std::vector<storage::PresenceItem> put_back_;
  /// What was last handed over, or is in the store.
  std::unordered_map<std::string, storage::StoredPresence> handed_;
  model::Seq last_number_ = 0;
  std::atomic<std::size_t> uncommitted_{0};
};

}  // namespace uplink::journal
