#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

/// The parts of a robot's live state, one row each: PART(Part, column, view, Message, keys_max).
///
///   Part      names it in code: LivePart::kPart. The number is its place in a row of a checkpoint,
///             so a new part goes last
///   column    its column of the table `live`, and its member of robot::LiveParts
///   view      as requests spell it: the JSON name of its field in uplink.v1.Robot
///   Message   the struct of schema/model that brings it; model::KeyOf says the key of one that has
///             a key
///   keys_max  keys that are kept of a robot, the least recently updated goes first; 1 if the part
///             has no key and a message replaces the one before
///
/// What is applied, checkpointed, restored, shown and compared is made from these rows. A new part
/// also needs a migration of each store for its column, and its field in fleet.proto.
#define UPLINK_LIVE_PARTS(PART)                                            \
  PART(Motion, motion, "motion", MotionTelemetry, 1)                       \
  PART(Status, status, "status", StatusTelemetry, 1)                       \
  PART(Extras, extras, "extras", TelemetryExtras, 1024)                    \
  PART(Health, health, "health", SystemHealth, 32)                         \
  PART(Usage, usage, "usage", UsageTelemetry, 1)                           \
  PART(Consumables, consumables, "consumables", ConsumableStatus, 64)      \
  PART(Directives, directives, "directives", SpatialDirectiveStatus, 1024) \
  PART(Rcan, rcan, "rcanState", RcanState, 1)

namespace uplink::storage {

/// The parts of a robot's live state, each written by itself. The order is that of the columns.
enum class LivePart : std::uint8_t {
#define UPLINK_PART(Part, column, view, Message, keys_max) k##Part,
  UPLINK_LIVE_PARTS(UPLINK_PART)
#undef UPLINK_PART
};

/// One row of the table above. A value.
struct LivePartRow {
  std::string_view column;
  std::string_view view;
  std::size_t keys_max = 1;
};

#define UPLINK_PART(Part, column, view, Message, keys_max) LivePartRow{#column, view, keys_max},
/// By LivePart.
inline constexpr auto kLiveParts = std::to_array<LivePartRow>({UPLINK_LIVE_PARTS(UPLINK_PART)});
#undef UPLINK_PART

inline constexpr std::size_t kLivePartKinds = kLiveParts.size();

[[nodiscard]] constexpr const LivePartRow& RowOf(LivePart part) {
  return kLiveParts[static_cast<std::size_t>(part)];
}

}  // namespace uplink::storage
