#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "server/fleet/fleet.h"
#include "server/view/glance.h"
#include "server/view/robots_filter.h"

namespace uplink::view {

/// The robots of the fleet by number, and the mark of each when it was last looked at (MarkOf).
/// Numbers of robots that are gone are given to others. It keeps no robot in memory.
///
/// Limits: one entry per robot of the fleet.
/// Thread: confined to its owner's lock.
class WatchedRobots final {
 public:
  /// It outlives this.
  explicit WatchedRobots(const fleet::Fleet& fleet) : fleet_(fleet) {}

  struct Seen {
    std::size_t number = 0;
    const RobotFacts& facts;
  };
  using OnRobot = std::function<void(const Seen& robot)>;
  using OnGone = std::function<void(std::size_t number, const std::string& ruri)>;

  /// Looks at all robots: tells which are gone since the last look, and which are new or have
  /// changed. `with_glances`: the facts have them.
  void LookAgain(const FilterSources& sources, bool with_glances, const OnGone& gone,
                 const OnRobot& changed);
  /// All robots of the last look, as they are now.
  void ForEach(const FilterSources& sources, bool with_glances, const OnRobot& each) const;
  /// Null if it is gone.
  [[nodiscard]] fleet::RobotPtr Find(std::size_t number) const {
    return number < entries_.size() ? entries_[number].robot.lock() : nullptr;
  }
  /// Forgets all robots, and their numbers.
  void Clear();

 private:
  struct Entry {
    std::weak_ptr<robot::Robot> robot;
    std::string ruri;
    std::string short_name;
    std::uint64_t mark = 0;
    /// Empty: its number is free.
    [[nodiscard]] bool free() const { return ruri.empty(); }
  };

  void Follow(const OnGone& gone);
  void Add(const fleet::RobotPtr& robot);

  const fleet::Fleet& fleet_;
  std::vector<Entry> entries_;
  std::vector<std::size_t> free_;
  std::unordered_map<std::string, std::size_t> by_ruri_;
  /// fleet::Fleet::changes, plus one; 0: it was never read.
  std::uint64_t followed_ = 0;
};

}  // namespace uplink::view
