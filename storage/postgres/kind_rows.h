#pragma once

#include "storage/postgres/pages.h"
#include "storage/postgres/result.h"
#include "storage/reader.h"

// The lists as they lie in the database, and what is made of their rows.
namespace uplink::storage::postgres {

inline constexpr ListShape kFaultHistory = {
    PageKind::kFaultHistory, "faults_history",
    "received_at, sampled_ms, fault_id, source, severity, category, description,"
    " suggested_action, active",
    "received_at"};
inline constexpr ListShape kFaultsActive = {
    PageKind::kFaultsActive, "faults_active",
    "received_at, sampled_ms, fault_id, source, severity, category, description,"
    " suggested_action, TRUE",
    "raised_at"};
inline constexpr ListShape kQuarantine = {
    PageKind::kQuarantine, "quarantine",
    "session, seq, reason, field, detail, payload_bytes, payload", "received_at"};
inline constexpr ListShape kGaps = {PageKind::kGaps, "gaps", "session, first, last", "seen_at"};
inline constexpr ListShape kEvents = {PageKind::kEvents, "events", "sampled_ms, kind, detail",
                                      "received_at"};
inline constexpr ListShape kMessages = {PageKind::kMessages, "messages",
                                        "sampled_ms, level, message", "received_at"};
inline constexpr ListShape kMissionRuns = {
    PageKind::kMissionRuns, "mission_runs",
    "mission_id, run_id, name, status, latest, last_at, updates", "first_at"};
inline constexpr ListShape kMissionReports = {PageKind::kMissionReports, "mission_reports",
                                              "mission_id, run_id, status, report", "received_at"};
inline constexpr ListShape kShapes = {
    PageKind::kShapes, "shapes",
    "received_at, expires_ms, id, name, rev, hash, area_type, scope, min_z_m, max_z_m, level_id,"
    " geometry",
    "first_at"};
inline constexpr ListShape kObjects = {
    PageKind::kObjects, "objects",
    "received_at, expires_ms, id, name, sampled_ms, object_type, scope, radius_m, location,"
    " trajectory",
    "first_at"};
inline constexpr ListShape kPresenceChanges = {PageKind::kPresence, "presence_changes", "presence",
                                               "changed_at"};

[[nodiscard]] ListFilter FilterOf(const MissionsQuery& query, bool open);
[[nodiscard]] ListFilter FilterOf(const PresentQuery& query);

[[nodiscard]] FaultRow ReadFault(const Result& rows, int row);
[[nodiscard]] FaultRow ReadActiveFault(const Result& rows, int row);
[[nodiscard]] QuarantineRow ReadQuarantine(const Result& rows, int row);
[[nodiscard]] GapRow ReadGap(const Result& rows, int row);
[[nodiscard]] EventRow ReadEvent(const Result& rows, int row);
[[nodiscard]] MessageRow ReadMessage(const Result& rows, int row);
[[nodiscard]] MissionRunRow ReadMissionRun(const Result& rows, int row);
[[nodiscard]] MissionReportRow ReadMissionReport(const Result& rows, int row);
[[nodiscard]] ShapeRow ReadShape(const Result& rows, int row);
[[nodiscard]] ObjectRow ReadObject(const Result& rows, int row);
[[nodiscard]] PresenceRow ReadPresence(const Result& rows, int row);

}  // namespace uplink::storage::postgres
