#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "schema/model/enum_text.h"

/// The modes of a drone, whose changes are durable. What is absent, or an empty text, is not
/// known.
namespace uplink::model::uncrew {

/// A value.
struct Armed {
  std::optional<bool> is_armed;

  friend bool operator==(const Armed&, const Armed&) = default;
};

/// The autopilot's modes.
enum class FlightModeKind : std::int32_t {};

/// A value.
struct FlightMode {
  FlightModeKind mode{};

  friend bool operator==(const FlightMode&, const FlightMode&) = default;
};

/// The mode of Uncrew's own flight controller. A value.
struct UncrewFlightMode {
  std::string mode;
  std::string detail;

  friend bool operator==(const UncrewFlightMode&, const UncrewFlightMode&) = default;
};

/// Counted from 0; equal to `total`: the mission is done. A value.
struct CurrentMissionItem {
  std::optional<std::int32_t> current;
  std::optional<std::int32_t> total;
  std::string mission_id;

  friend bool operator==(const CurrentMissionItem&, const CurrentMissionItem&) = default;
};

}  // namespace uplink::model::uncrew

namespace uplink::model {

template <>
inline constexpr auto kEnumNames<uncrew::FlightModeKind> = std::to_array<std::string_view>(
    {"unknown", "ready", "takeoff", "hold", "mission", "return_to_launch", "land", "offboard",
     "follow_me", "manual", "altctl", "posctl", "acro", "stabilized", "rattitude"});

}  // namespace uplink::model
