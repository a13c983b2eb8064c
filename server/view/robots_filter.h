#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "server/fleet/robot_settings.h"
#include "server/robot/robot.h"
#include "server/view/fault_counts.h"
#include "server/view/glance.h"
#include "server/view/robots_query.h"

namespace uplink::view {

/// What a filter looks at beside the robots. A view.
struct FilterSources {
  LiveSources live{};
  /// Null: unknown.
  const FaultCounts::Map* faults = nullptr;
  /// Null: nothing is set of any robot.
  const fleet::RobotSettings* settings = nullptr;
};

/// The last two segments of a RURI, in lower case: what RobotsFilter::q looks at. Pure.
[[nodiscard]] std::string ShortNameOf(std::string_view ruri);

/// What a filter judges a robot by. A view.
struct RobotFacts {
  std::string_view ruri;
  std::string_view fleet;
  /// As ShortNameOf.
  std::string_view short_name;
  robot::Presence presence = robot::Presence::kUnknown;
  SystemTime presence_since{};
  bool held_back = false;
  /// For filters that look.
  const Glance& glance;
};

/// One filter, for many robots.
///
/// Thread: confined to one.
class FilteredRobots final {
 public:
  /// `filter` outlives it. `with_glances`: the caller wants them also of robots that are not
  /// filtered by them.
  explicit FilteredRobots(const RobotsFilter& filter, bool with_glances = false);

  /// Whether it looks at more than names and presence, and so needs its sources.
  [[nodiscard]] bool looks() const { return looks_; }
  /// What they point at outlives it.
  void SetSources(const FilterSources& sources) { sources_ = sources; }

  enum class Match : std::uint8_t {
    kNo,
    kYes,
    /// It may match, but another process holds it, and the store has not told what the filter asks
    /// about.
    kUnknown,
  };
  /// Sets `glance` if looks().
  [[nodiscard]] Match Look(const robot::Robot& robot, std::string_view short_name, Glance& glance);
  /// The same by facts that were taken before.
  [[nodiscard]] Match Judge(const RobotFacts& facts) const;

 private:
  [[nodiscard]] bool MatchesName(std::string_view ruri, std::string_view fleet,
                                 std::string_view short_name) const;
  [[nodiscard]] bool AsksForPresence() const;
  [[nodiscard]] bool MatchesPresence(robot::Presence presence, SystemTime since) const;
  [[nodiscard]] Match MatchesValues(const RobotFacts& facts) const;
  [[nodiscard]] bool MatchesSet(std::string_view ruri) const;
  /// Empty: unknown, as in all that it is judged by.
  [[nodiscard]] std::optional<bool> HasFaults(const RobotFacts& facts) const;

  const RobotsFilter& filter_;
  const std::string q_;
  const bool looks_;
  FilterSources sources_{};
};

}  // namespace uplink::view
