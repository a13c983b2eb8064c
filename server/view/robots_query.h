#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "schema/base/clock.h"
#include "server/robot/presence.h"
#include "server/view/parts.h"
#include "storage/reader.h"

namespace uplink::view {

/// A rectangle of the globe, edges included. One whose west is east of its east crosses the 180th
/// meridian (RFC 7946, 5.2). A value.
struct BoundingBox {
  double west = 0;
  double south = 0;
  double east = 0;
  double north = 0;

  [[nodiscard]] bool Contains(double latitude, double longitude) const {
    if (latitude < south || latitude > north) return false;
    if (west <= east) return longitude >= west && longitude <= east;
    return longitude >= west || longitude <= east;
  }

  friend bool operator==(const BoundingBox&, const BoundingBox&) = default;
};

/// By what a list of robots is ordered. A robot without the value comes last, either way.
enum class RobotsBy : std::uint8_t { kRuri, kBattery, kLastHeard, kBacklog };
inline constexpr std::array<std::string_view, 4> kRobotsByNames = {"ruri", "battery", "lastHeard",
                                                                   "backlog"};
/// An order of robots; of two with the same value the lower RURI comes first. A value.
struct RobotsOrder {
  RobotsBy by = RobotsBy::kRuri;
  /// The highest value first.
  bool descending = false;

  friend bool operator==(const RobotsOrder&, const RobotsOrder&) = default;
};

/// Robots by what they reported and by their connections. What is empty matches every robot; a
/// robot whose value is unknown matches no condition on it. A value.
struct ValuesFilter {
  /// In percent.
  std::optional<double> battery_below{};
  /// Positions in a local frame never match.
  std::optional<BoundingBox> bbox{};
  /// The version of its agent, or of its software.
  std::string software{};
  std::optional<bool> held_back{};
  std::optional<bool> estop{};
  /// Its status says so, or it has active faults.
  std::optional<bool> faulted{};
  /// The certificate of its connection to this server expires before that.
  std::optional<SystemTime> certificate_expires_before{};

  friend bool operator==(const ValuesFilter&, const ValuesFilter&) = default;
};

/// Robots by what operators set of them. What is empty matches every robot. A value.
struct SetFilter {
  /// A robot has all of these: names and values.
  std::vector<std::pair<std::string, std::string>> labels{};
  std::optional<bool> blocked{};

  friend bool operator==(const SetFilter&, const SetFilter&) = default;
};

/// Which robots: by names and presence, which are known of every robot, and by values. What is
/// empty matches every robot. A value.
struct RobotsFilter {
  std::vector<std::string> fleets{};
  /// Ascending, at most storage::kRurisMax; none: all.
  std::vector<std::string> ruris{};
  /// A part of the last two segments of the RURI, in any case.
  std::string q{};
  std::optional<robot::Presence> presence{};
  /// Offline since before that.
  std::optional<SystemTime> offline_before{};
  SetFilter set{};
  ValuesFilter values{};
};

/// A page of robots. A value.
struct RobotsQuery {
  RobotsFilter filter{};
  RobotsOrder order{};
  /// 1 to storage::kPageSizeMax.
  std::uint32_t page_size = storage::kPageSizeDefault;
  std::string page_token{};
  /// Live parts are copied, and the store is asked for its own, only if one of them is wanted.
  PartSet parts = PartSet::OfLists();
};

}  // namespace uplink::view
