#pragma once

#include <absl/status/statusor.h>

#include "storage/reader.h"
#include "storage/sqlite/pages.h"
#include "storage/sqlite/statement.h"

// The lists as they lie in the file, and what is made of their rows.
namespace uplink::storage::sqlite {

inline constexpr ListShape kFaultHistory = {
    PageKind::kFaultHistory, "faults_history",
    "received_ms, sampled_ms, fault_id, source, severity, category, description,"
    " suggested_action, active",
    "received_ms"};
inline constexpr ListShape kFaultsActive = {
    PageKind::kFaultsActive, "faults_active",
    "received_ms, sampled_ms, fault_id, source, severity, category, description,"
    " suggested_action, 1",
    "raised_ms"};
inline constexpr ListShape kQuarantine = {
    PageKind::kQuarantine, "quarantine",
    "session, seq, reason, field, detail, payload_bytes, payload", "received_ms"};
inline constexpr ListShape kGaps = {PageKind::kGaps, "gaps", "session, first, last", "seen_ms"};
inline constexpr ListShape kEvents = {PageKind::kEvents, "events", "sampled_ms, kind, detail",
                                      "received_ms"};
inline constexpr ListShape kMessages = {PageKind::kMessages, "messages",
                                        "sampled_ms, level, message", "received_ms"};
inline constexpr ListShape kMissionRuns = {
    PageKind::kMissionRuns, "mission_runs",
    "mission_id, run_id, name, status, latest, last_ms, updates", "first_ms"};
inline constexpr ListShape kMissionReports = {PageKind::kMissionReports, "mission_reports",
                                              "mission_id, run_id, status, report", "received_ms"};
inline constexpr ListShape kShapes = {
    PageKind::kShapes, "shapes",
    "received_ms, expires_ms, id, name, rev, hash, area_type, scope, min_z_m, max_z_m, level_id,"
    " geometry",
    "first_ms"};
inline constexpr ListShape kObjects = {
    PageKind::kObjects, "objects",
    "received_ms, expires_ms, id, name, sampled_ms, object_type, scope, radius_m, location,"
    " trajectory",
    "first_ms"};
inline constexpr ListShape kPresenceChanges = {PageKind::kPresence, "presence_changes", "presence",
                                               "at_ms"};

[[nodiscard]] ListFilter FilterOf(const MissionsQuery& query, bool open);
[[nodiscard]] ListFilter FilterOf(const PresentQuery& query);

// Errors: kInternal for a row that no program of ours wrote.
[[nodiscard]] absl::StatusOr<FaultRow> ReadFault(const Rows& rows);
[[nodiscard]] absl::StatusOr<FaultRow> ReadActiveFault(const Rows& rows);
[[nodiscard]] absl::StatusOr<QuarantineRow> ReadQuarantine(const Rows& rows);
[[nodiscard]] absl::StatusOr<GapRow> ReadGap(const Rows& rows);
[[nodiscard]] absl::StatusOr<EventRow> ReadEvent(const Rows& rows);
[[nodiscard]] absl::StatusOr<MessageRow> ReadMessage(const Rows& rows);
[[nodiscard]] absl::StatusOr<MissionRunRow> ReadMissionRun(const Rows& rows);
[[nodiscard]] absl::StatusOr<MissionReportRow> ReadMissionReport(const Rows& rows);
[[nodiscard]] absl::StatusOr<ShapeRow> ReadShape(const Rows& rows);
[[nodiscard]] absl::StatusOr<ObjectRow> ReadObject(const Rows& rows);
[[nodiscard]] absl::StatusOr<PresenceRow> ReadPresence(const Rows& rows);

}  // namespace uplink::storage::sqlite
