#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "server/robot/robot.h"
#include "server/view/fault_counts.h"
#include "server/view/foreign_glances.h"
#include "server/view/glance.h"
#include "server/view/robots_query.h"

namespace uplink::view {

/// What a filter looks at beside the robots. A view.
struct FilterSources {
  LiveSources live{};
  const ForeignGlances::Map* foreign = nullptr;
  /// Null: unknown.
  const FaultCounts::Map* faults = nullptr;
};

/// The last two segments of a RURI, in lower case: what RobotsFilter::q looks at. Pure.
[[nodiscard]] std::string ShortNameOf(std::string_view ruri);

/// One filter, for many robots.
///
/// Thread: confined to one.
class FilteredRobots final {
 public:
  /// Both outlive it. `with_glances`: the caller wants them also of robots that are not filtered by
  /// them.
  FilteredRobots(const RobotsFilter& filter, const FilterSources& sources,
                 bool with_glances = false);

  enum class Match : std::uint8_t {
    kNo,
    kYes,
    /// Another process holds it, and the store has not told what the filter asks about.
    kUnknown,
  };
  /// Sets `glance` if it was needed.
  [[nodiscard]] Match Look(const robot::Robot& robot, std::string_view short_name, Glance& glance);

  /// Whether such a filter asks about more than names and presence.
  [[nodiscard]] static bool NeedsGlances(const RobotsFilter& filter);

 private:
  [[nodiscard]] bool MatchesName(const robot::Robot& robot, std::string_view short_name) const;
  [[nodiscard]] bool MatchesPresence(const robot::Robot& robot) const;
  /// What the robot reported, and the versions.
  [[nodiscard]] bool MatchesValues(const Glance& glance) const;
  [[nodiscard]] bool MatchesCertificate(const Glance& glance) const;
  [[nodiscard]] bool HasFaults(const robot::Robot& robot, const Glance& glance) const;
  /// The same of a robot that another process holds.
  [[nodiscard]] Match LookAtForeign(const robot::Robot& robot, Glance& glance) const;

  const RobotsFilter& filter_;
  const FilterSources sources_;
  const std::string q_;
  const bool looks_;
};

}  // namespace uplink::view
