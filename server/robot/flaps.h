#pragma once

#include <algorithm>
#include <cstddef>
#include <deque>

#include "schema/base/clock.h"
#include "server/config/config.h"

namespace uplink::robot {

/// Whether a robot comes and goes: so many changes between online and offline within so long.
/// Confined to its owner's lock.
///
/// Bound: the times of the last kChangesMax changes.
class Flaps final {
 public:
  /// The most that Limits::changes may be.
  static constexpr std::size_t kChangesMax = 100;
  struct Limits {
    /// presence.flap_changes, presence.flap_window.
    std::size_t changes = config::PresenceConfig().flap_changes;
    milliseconds window = config::PresenceConfig().flap_window;
  };

  /// The robot went from online to offline, or came back.
  void Add(SteadyTime at) {
    changes_.push_back(at);
    if (changes_.size() > kChangesMax) changes_.pop_front();
  }
  /// Judges what was added until now.
  void Reach(SteadyTime now, const Limits& limits) {
    while (!changes_.empty() && now - changes_.front() >= limits.window) changes_.pop_front();
    flapping_ = changes_.size() >= std::min(limits.changes, kChangesMax);
  }
  [[nodiscard]] bool flapping() const { return flapping_; }

 private:
  std::deque<SteadyTime> changes_;
  bool flapping_ = false;
};

}  // namespace uplink::robot
