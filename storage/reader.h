#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <absl/status/statusor.h>

#include "schema/base/clock.h"
#include "schema/model/ids.h"
#include "schema/model/mission.h"
#include "schema/model/presence.h"
#include "schema/model/rejection.h"
#include "schema/model/reports.h"
#include "schema/model/spatial.h"
#include "storage/live_row.h"

namespace uplink::storage {

inline constexpr std::uint32_t kPageSizeDefault = 100;
inline constexpr std::uint32_t kPageSizeMax = 1'000;
/// Bytes of texts and payloads after which a page ends early, with a token: a thousand rows can be
/// as many quarter megabytes.
inline constexpr std::size_t kPageBytesMax = 16U * 1024 * 1024;

/// Which rows, and which part of them. Empty texts match everything.
struct HistoryQuery {
  std::string ruri;
  std::string fleet;
  /// Arrival times, both inclusive.
  std::optional<SystemTime> from;
  std::optional<SystemTime> to;
  /// 1 to kPageSizeMax.
  std::uint32_t page_size = kPageSizeDefault;
  /// next_token of the page before; empty for the first.
  std::string page_token;
};

/// Which mission runs. Empty texts match everything.
struct MissionsQuery {
  HistoryQuery rows;
  std::string mission_id;
  std::string run_id;
  /// Only runs whose latest status is not terminal.
  bool open = false;
};

/// Which shapes or objects.
struct PresentQuery {
  HistoryQuery rows;
  /// What expired at or before this time is left out.
  SystemTime now;
  /// Also those that expired and are not yet swept.
  bool include_expired = false;
};

/// Newest first by arrival. A token stays valid while rows are added: a walk sees every row that
/// was there when it began exactly once.
template <typename Row>
struct Page {
  std::vector<Row> rows;
  /// Empty when this page is the last.
  std::string next_token;
};

struct RobotRow {
  model::RobotId robot;
  SystemTime first_seen;
  SystemTime last_seen;
  /// The last presence change that the store has.
  std::optional<model::Presence> last_presence;
};

struct FaultRow {
  model::RobotId robot;
  model::Fault fault;
  SystemTime received_at;
  /// First raise since it was last clear; only in rows of the active set.
  std::optional<SystemTime> raised_at;
};

struct QuarantineRow {
  model::RobotId robot;
  model::SessionId session;
  model::Seq seq = 0;
  model::Rejection rejection;
  SystemTime received_at;
  std::string payload;
  std::uint64_t payload_bytes = 0;
};

struct GapRow {
  model::RobotId robot;
  model::SessionId session;
  model::Seq first = 0;
  model::Seq last = 0;
  SystemTime seen_at;
};

struct EventRow {
  model::RobotId robot;
  /// The union member's name.
  std::string kind;
  /// What it holds: json::DetailText.
  std::string detail_json;
  /// The robot's clock, Unix milliseconds; 0 if unknown. So everywhere below.
  std::int64_t sampled_at_ms = 0;
  SystemTime received_at;
};

struct MessageRow {
  model::RobotId robot;
  model::Message message;
  SystemTime received_at;
};

/// One run of a mission: (robot, mission_id, run_id). Stands in lists by its first arrival, so that
/// a run that goes on keeps its place.
struct MissionRunRow {
  model::RobotId robot;
  std::string mission_id;
  std::string run_id;
  /// The last name that a report gave.
  std::string name;
  model::MissionStatus status = model::MissionStatus::kUnknown;
  /// The latest report: json::Text.
  std::string latest_json;
  SystemTime first_received_at;
  SystemTime last_received_at;
  /// Reports so far.
  std::uint64_t updates = 0;
};

/// One report of a run.
struct MissionReportRow {
  model::RobotId robot;
  std::string mission_id;
  std::string run_id;
  model::MissionStatus status = model::MissionStatus::kUnknown;
  std::string report_json;
  SystemTime received_at;
};

/// A shape that is there. Stands in lists by the arrival of the upsert that made its id present, so
/// that one that changes keeps its place.
struct ShapeRow {
  model::RobotId robot;
  model::AssetIdentity identity;
  model::ReportedLayerRole area_type = model::ReportedLayerRole::kCoverage;
  model::ScopeType scope = model::ScopeType::kRobot;
  /// GeoJSON: json::GeometryText.
  std::string geometry_json;
  /// Unix milliseconds; 0: never.
  std::int64_t expires_at_ms = 0;
  double min_z_m = 0;
  double max_z_m = 0;
  std::int32_t level_id = 0;
  /// Of the latest upsert.
  SystemTime received_at;
};

/// An object that is there; in lists as ShapeRow.
struct ObjectRow {
  model::RobotId robot;
  std::string id;
  std::string name;
  model::ObjectType object_type = model::ObjectType::kUnknown;
  model::ScopeType scope = model::ScopeType::kRobot;
  /// json::Text of the pose.
  std::string location_json;
  /// json::Text of the trajectory; empty if there is none.
  std::string trajectory_json;
  double radius_m = 0;
  std::int64_t sampled_at_ms = 0;
  /// With StoreRules.object_ttl applied; 0: never.
  std::int64_t expires_at_ms = 0;
  SystemTime received_at;
};

struct PresenceRow {
  model::RobotId robot;
  model::Presence presence = model::Presence::kUnknown;
  SystemTime at;
};

/// The kinds of which the store keeps a robot's latest.
enum class LatestKind : std::uint8_t { kAgentInfo = 0, kSettings = 1, kUiCapabilities = 2 };
inline constexpr std::size_t kLatestKinds = 3;

struct LatestRow {
  std::string ruri;
  LatestKind kind = LatestKind::kAgentInfo;
  /// json::Text.
  std::string body_json;
  SystemTime received_at;
};

struct ActiveFaults {
  std::string ruri;
  std::int64_t count = 0;
  /// Of the same by FaultSeverity; the last: of severities beyond those known.
  std::array<std::int64_t, model::kEnumNames<model::FaultSeverity>.size() + 1> by_severity{};

  void Add(std::int64_t severity, std::int64_t faults) {
    count += faults;
    const auto known = static_cast<std::int64_t>(by_severity.size()) - 1;
    const bool recognized = severity >= 0 && severity < known;
    by_severity[static_cast<std::size_t>(recognized ? severity : known)] += faults;
  }
};

/// The query side of the store.
///
/// Errors:  kInvalidArgument for a page token that is none of ours (the message begins with
///          `pageToken`); kUnavailable and the like as in Store.
/// Thread:  thread-safe; a slow read never holds up a commit.
class Reader {
 public:
  virtual ~Reader() = default;

  /// Robots that ever opened a stream, by RURI, at most `robots_max`.
  [[nodiscard]] virtual absl::StatusOr<std::vector<RobotRow>> Robots(std::uint32_t robots_max) = 0;
  /// Faults that are active now, one row per fault.
  [[nodiscard]] virtual absl::StatusOr<Page<FaultRow>> FaultsActive(const HistoryQuery& query) = 0;
  /// Every report of a fault.
  [[nodiscard]] virtual absl::StatusOr<Page<FaultRow>> FaultHistory(const HistoryQuery& query) = 0;
  /// The number of active faults of each of `ruris`; robots without any may be left out.
  [[nodiscard]] virtual absl::StatusOr<std::vector<ActiveFaults>> ActiveFaultCounts(
      std::span<const std::string> ruris) = 0;
  [[nodiscard]] virtual absl::StatusOr<Page<QuarantineRow>> Quarantine(
      const HistoryQuery& query) = 0;
  [[nodiscard]] virtual absl::StatusOr<Page<GapRow>> Gaps(const HistoryQuery& query) = 0;

  [[nodiscard]] virtual absl::StatusOr<Page<EventRow>> Events(const HistoryQuery& query) = 0;
  [[nodiscard]] virtual absl::StatusOr<Page<MessageRow>> Messages(const HistoryQuery& query) = 0;
  /// from and to are of the first arrival.
  [[nodiscard]] virtual absl::StatusOr<Page<MissionRunRow>> MissionRuns(
      const MissionsQuery& query) = 0;
  /// Every report of the runs that match; `open` has no meaning here.
  [[nodiscard]] virtual absl::StatusOr<Page<MissionReportRow>> MissionReports(
      const MissionsQuery& query) = 0;
  [[nodiscard]] virtual absl::StatusOr<Page<ShapeRow>> Shapes(const PresentQuery& query) = 0;
  [[nodiscard]] virtual absl::StatusOr<Page<ObjectRow>> Objects(const PresentQuery& query) = 0;
  [[nodiscard]] virtual absl::StatusOr<Page<PresenceRow>> PresenceChanges(
      const HistoryQuery& query) = 0;
  /// What the store has of each of `ruris`, of the kinds whose bit (1 << LatestKind) is set in
  /// `kinds`. Stops after the robot with which the bodies passed kPageBytesMax; `ruris` that come
  /// after it are not looked at, and `complete` robots were.
  struct LatestRows {
    std::vector<LatestRow> rows;
    /// The number of `ruris` that were looked at; at least 1 if there is any.
    std::size_t complete = 0;
  };
  [[nodiscard]] virtual absl::StatusOr<LatestRows> Latest(std::span<const std::string> ruris,
                                                          std::uint32_t kinds) = 0;
  /// The live states that were checkpointed, by RURI, from the first that comes after `after` on:
  /// at most kLiveRowsMax, and fewer where their bytes pass kPageBytesMax; none after the last.
  [[nodiscard]] virtual absl::StatusOr<std::vector<LiveRow>> Live(std::string_view after) = 0;
};

/// A list of Reader that takes a HistoryQuery: `&Reader::Events`.
template <typename Row>
using HistoryList = absl::StatusOr<Page<Row>> (Reader::*)(const HistoryQuery& query);

}  // namespace uplink::storage
