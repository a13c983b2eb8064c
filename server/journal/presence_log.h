#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <unordered_map>
#include <vector>

#include "schema/model/presence.h"
#include "storage/types.h"

namespace uplink::journal {

/// The changes of presence that wait for a commit: at most one a robot, the latest. One that leads
/// back to what was last handed over is no change any more and waits no longer.
///
/// Limits: as many entries as there are robots (limits.robots_max), which the fleet keeps.
/// Thread: confined to its owner's lock.
class PresenceLog final {
 public:
  /// What the store holds of the robot already.
  void SetStored(const std::string& ruri, model::Presence presence) { handed_[ruri] = presence; }
  /// A change of the robot was noted, or what the store holds was told.
  [[nodiscard]] bool Knows(const std::string& ruri) const {
    return handed_.contains(ruri) || waiting_.contains(ruri);
  }
  void Note(const storage::RobotRef& robot, model::Presence presence, SystemTime at);
  /// Hands over at most `items_max` changes, numbered; whoever takes them commits them in order
  /// before it takes more.
  [[nodiscard]] std::vector<storage::PresenceItem> Take(std::size_t items_max);

  [[nodiscard]] bool empty() const { return waiting_.empty(); }
  [[nodiscard]] std::size_t size() const { return waiting_.size(); }

 private:
  /// By RURI, so that a run repeats exactly.
  std::map<std::string, storage::PresenceItem> waiting_;
  std::unordered_map<std::string, model::Presence> handed_;
  model::Seq last_number_ = 0;
};

}  // namespace uplink::journal
