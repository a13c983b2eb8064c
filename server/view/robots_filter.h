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

 private:
  [[nodiscard]] bool MatchesName(const robot::Robot& robot, std::string_view short_name) const;
  [[nodiscard]] bool MatchesPresence(const robot::Robot& robot) const;
  [[nodiscard]] bool MatchesSet(const robot::Robot& robot) const;
  [[nodiscard]] Match MatchesValues(const robot::Robot& robot, const Glance& glance) const;
  /// Empty: unknown, as in all that it is judged by.
  [[nodiscard]] std::optional<bool> HasFaults(const robot::Robot& robot,
                                              const Glance& glance) const;

  const RobotsFilter& filter_;
  const std::string q_;
  const bool looks_;
  FilterSources sources_{};
};

}  // namespace uplink::view
