#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <string_view>

#include "schema/model/enum_text.h"
#include "schema/model/spatial.h"

namespace uplink::model {

/// What an area means to the robots that receive it. Those from kCoverage on are the roles in
/// which robots report areas; we send no other.
enum class LayerRole : std::uint16_t {
  kAllowedArea = 0,
  kPreferred = 1,
  kKeepout = 2,
  kSoftExclusion = 3,
  kWorkArea = 4,
  kTarget = 5,
  kQueue = 6,
  kControlZone = 7,
  kTriggerZone = 8,
  kUnused9 = 9,
  kCoverage = 10,
  kOccupied = 11,
  kReserved = 12,
  kConsumed = 13,
  kHazard = 14,
  kBlocked = 15,
  kPlannedPath = 16,
};
template <>
inline constexpr auto kEnumNames<LayerRole> = std::to_array<std::string_view>(
    {"allowedArea", "preferred", "keepout", "softExclusion", "workArea", "target", "queue",
     "controlZone", "triggerZone", "unused9", "coverage", "occupied", "reserved", "consumed",
     "hazard", "blocked", "plannedPath"});

/// How far the number of a role lies above that of the reported role of the same name.
inline constexpr std::uint16_t kReportedRoleOffset = 10;

static_assert(kEnumNames<LayerRole>.size() ==
              kEnumNames<ReportedLayerRole>.size() + kReportedRoleOffset);

/// The role of the same name. A reported number without a name is moved likewise, so that it never
/// falls on a role with a name; the highest ones meet at the highest number.
[[nodiscard]] constexpr LayerRole LayerRoleOf(ReportedLayerRole reported) {
  constexpr std::uint16_t kLast = std::numeric_limits<std::uint16_t>::max() - kReportedRoleOffset;
  return static_cast<LayerRole>(std::min(static_cast<std::uint16_t>(reported), kLast) +
                                kReportedRoleOffset);
}

}  // namespace uplink::model
