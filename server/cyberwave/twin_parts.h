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

/// The metrics of one category, by its last message.
using MetricCategory = Held<std::vector<model::cyberwave::Metric>>;

using HeldReport = Held<model::cyberwave::Report>;

/// The live state of one robot of a twin, the real or the simulated one. A part that was never
/// reported is empty. A value.
struct TwinParts {
  model::cyberwave::Uuid twin;

  std::optional<Held<model::cyberwave::Position>> position;
  std::optional<Held<model::cyberwave::Rotation>> rotation;
  std::optional<Held<model::cyberwave::Scale>> scale;
  std::optional<Held<model::cyberwave::Gps>> gps;
  std::optional<Held<model::cyberwave::BatteryStatus>> battery;
  JointTable joints;
  /// By category; a category that a message does not name stays.
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

/// What a robot of a twin loses, one by one, if all live states together take too much memory:
/// tables by key, and whole reports.
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
/// Memory of each table, by TwinTable.
using TwinTableBytes = std::array<std::size_t, kTwinTables>;
[[nodiscard]] TwinTableBytes TableBytes(const TwinParts& parts);

/// The most memory of one robot of a twin; twin_parts.cc computes and checks it.
inline constexpr std::size_t kTwinBytesMax = std::size_t{5} * 1024 * 1024;

/// Bytes in memory, its own size included.
[[nodiscard]] std::size_t HeldBytes(const TwinParts& parts);

}  // namespace uplink::cyberwave
