#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <string_view>

#include "server/robot/presence.h"
#include "server/robot/robot_state.h"

namespace uplink::fleet {

/// A robot's certificate that is valid for less than this counts as expiring: time enough to renew
/// it.
inline constexpr std::chrono::hours kCertificateExpiring{14 * 24};
/// The same as metrics name it.
inline constexpr std::string_view kCertificateExpiringText = "14d";

/// How many robots have each presence.
struct PresenceTally {
  std::int64_t unknown = 0;
  std::int64_t online = 0;
  std::int64_t offline = 0;
  /// Of the offline ones, those that are parked.
  std::int64_t parked = 0;
  /// Of all, those that come and go.
  std::int64_t flapping = 0;

  void Count(robot::Presence presence, const robot::RobotState& state);
  PresenceTally& operator+=(const PresenceTally& other);
  [[nodiscard]] std::int64_t all() const { return unknown + online + offline; }
};

/// The counts of the robots of one fleet. A value.
struct FleetTally {
  /// Robots that this process judges.
  PresenceTally here;
  /// Robots that other processes hold, by the presence that those wrote.
  PresenceTally elsewhere;
  /// Robots that are connected to this process by a certificate that expires within
  /// kCertificateExpiring.
  std::int64_t certificates_expiring = 0;

  FleetTally& operator+=(const FleetTally& other);
  [[nodiscard]] std::int64_t robots() const { return here.all() + elsewhere.all(); }
};

/// By the name of the fleet.
using FleetTallies = std::map<std::string, FleetTally, std::less<>>;

/// The name under which metrics show the fleets beyond metrics.fleets_max together.
inline constexpr std::string_view kOtherFleets = "_other";

/// Which fleets metrics name. A fleet keeps its place as long as it has robots, so that its series
/// go on; a free place goes to the fleet with most robots.
///
/// Limits:  `fleets_max` names, and kOtherFleets.
/// Thread:  confined to one thread.
class ShownFleets final {
 public:
  explicit ShownFleets(std::size_t fleets_max) : fleets_max_(fleets_max) {}

  /// The tallies of the fleets that are named; those of all others are one. Never empty: without a
  /// robot kOtherFleets has none.
  [[nodiscard]] FleetTallies Fold(const FleetTallies& tallies);

 private:
  /// Gives free places to fleets that have none.
  void Fill(const FleetTallies& tallies);

  std::size_t fleets_max_;
  std::set<std::string, std::less<>> shown_;
};

}  // namespace uplink::fleet
