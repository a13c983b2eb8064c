#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "schema/model/cyberwave/health.h"
#include "schema/model/cyberwave/pose.h"
#include "schema/model/cyberwave/reports.h"
#include "schema/model/cyberwave/uuid.h"
#include "server/cyberwave/held.h"
#include "server/cyberwave/joint_table.h"
#include "server/cyberwave/latest_within.h"
#include "server/cyberwave/observed_counts.h"
#include "server/cyberwave/session_marks.h"

namespace uplink::cyberwave {

/// The metrics of one category, as its last message said them.
using MetricCategory = Held<std::vector<model::cyberwave::Metric>>;

using HeldReport = Held<model::cyberwave::Report>;

/// What is known of one robot of a twin, the real one or the simulated one. A part that was never
/// said is empty. A value.
struct TwinParts {
  model::cyberwave::Uuid twin;

  std::optional<Held<model::cyberwave::Position>> position;
  std::optional<Held<model::cyberwave::Rotation>> rotation;
  std::optional<Held<model::cyberwave::Scale>> scale;
  std::optional<Held<model::cyberwave::Gps>> gps;
  std::optional<Held<model::cyberwave::BatteryStatus>> battery;
  JointTable joints;
  /// By category; one that a message does not name stays.
  LatestWithin<MetricCategory, kMetricCategoriesMax, kTableBytesMax> metrics;
  /// By edge_id.
  LatestWithin<Held<model::cyberwave::EdgeHealth>, kEdgesMax, kTableBytesMax> edges;
  std::optional<HeldReport> motors;
  std::optional<HeldReport> driver_info;
  /// By `telemetry_type`, and `robot_state`.
  LatestWithin<HeldReport, kReportsMax, kTableBytesMax> reports;
  SessionMarks sessions;
  ObservedCounts observed;
};

/// What a robot of a twin loses, one by one, where the live states of all hold too much: what is
/// held by keys, and whole reports.
enum class TwinTable : std::uint8_t {
  kJoints,
  kMetrics,
  kEdges,
  kReports,
  kMotors,
  kDriverInfo,
  kSessions,
};
inline constexpr std::size_t kTwinTables = static_cast<std::size_t>(TwinTable::kSessions) + 1;
/// Memory of each, by TwinTable.
using TwinTableBytes = std::array<std::size_t, kTwinTables>;
[[nodiscard]] TwinTableBytes TableBytes(const TwinParts& parts);

/// Memory of the largest robot of a twin, checked where it is computed (twin_parts.cc).
inline constexpr std::size_t kTwinBytesMax = std::size_t{5} * 1024 * 1024;

/// What it holds in memory, itself included.
[[nodiscard]] std::size_t HeldBytes(const TwinParts& parts);

}  // namespace uplink::cyberwave
