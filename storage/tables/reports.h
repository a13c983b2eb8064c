#pragma once

#include <array>
#include <string_view>

#include "schema/base/clock.h"
#include "schema/json/text.h"
#include "schema/model/operator_request.h"
#include "schema/model/reports.h"
#include "schema/model/scope_update.h"
#include "storage/commit_record.h"
#include "storage/rows.h"
#include "storage/tables/table.h"

// What is reported and kept as it came: faults, events, messages, updates of what is no robot; and
// requests to operators, a row each.
namespace uplink::storage {

/// A row that a report of a robot makes. The pointers lead into the batch.
template <typename Body>
struct Report {
  const CommitRecord* record = nullptr;
  const Body* body = nullptr;
  Entry entry;
};

using FaultReport = Report<model::Fault>;
using EventReport = Report<model::EventTelemetry>;
using MessageReport = Report<model::Message>;
using ScopeReport = Report<model::ScopeUpdate>;

/// The columns with which every history of robots' messages begins. In: has `record` and `entry`.
template <typename In, typename Out>
inline constexpr std::array<Column<In, Out>, 6> kReportColumns = {{
    kRobotRuri,
    Col("received_at", [](const auto& row) { return row.record->received_at; }),
    kRowEntry,
    kRobotFleet,
    Col(
        "session", [](const auto& row) { return row.record->session; },
        [](auto& row) -> decltype(&row.session) { return &row.session; }),
    Col(
        "seq", [](const auto& row) { return row.record->seq; },
        [](auto& row) -> decltype(&row.seq) { return &row.seq; }),
}};

/// Lists of histories stand by the arrival.
template <typename Out>
constexpr Listed<Out> ByArrival() {
  return {"received_at", [](SystemTime time, Out& row) { row.received_at = time; }};
}

constexpr model::Fault& BodyOf(FaultRow& row) { return row.fault; }
constexpr model::Message& BodyOf(MessageRow& row) { return row.message; }
constexpr model::ScopeUpdate& BodyOf(ScopeUpdateRow& row) { return row.update; }

/// What names a fault of a robot, and what it says beside that. In: has `body`.
template <typename In>
inline constexpr std::array<Column<In, FaultRow>, 7> kFaultColumns = {{
    Same<&model::Fault::fault_id>("fault_id").Key(),
    Same<&model::Fault::source>("source").Key(),
    Same<&model::Fault::unix_time_ms>("sampled_ms"),
    Same<&model::Fault::severity>("severity"),
    Same<&model::Fault::category>("category"),
    Same<&model::Fault::description>("description"),
    Same<&model::Fault::suggested_action>("suggested_action"),
}};

inline constexpr Table<FaultReport, FaultRow, 14> kFaultHistoryTable = {
    "faults_history", Writes::kInserts, ByArrival<FaultRow>(),
    Join(kReportColumns<FaultReport, FaultRow>,
         Join(kFaultColumns<FaultReport>, std::array<Column<FaultReport, FaultRow>, 1>{
                                              Same<&model::Fault::active>("active")}))};

inline constexpr Table<EventReport, EventRow, 9> kEventsTable = {
    "events", Writes::kInserts, ByArrival<EventRow>(),
    Join(kReportColumns<EventReport, EventRow>,
         std::array<Column<EventReport, EventRow>, 3>{
             Col<&EventRow::sampled_at_ms>("sampled_ms",
                                           [](const auto& row) { return row.body->unix_time_ms; }),
             Col<&EventRow::kind>(
                 "kind", [](const auto& row) { return model::EventKindText(row.body->kind); }),
             Col<&EventRow::detail_json>(
                 "detail", [](const auto& row) { return json::DetailText(row.body->kind); }),
         })};

inline constexpr Table<MessageReport, MessageRow, 11> kMessagesTable = {
    "messages", Writes::kInserts, ByArrival<MessageRow>(),
    Join(kReportColumns<MessageReport, MessageRow>,
         std::array<Column<MessageReport, MessageRow>, 5>{
             Same<&model::Message::unix_time_ms>("sampled_ms"),
             Same<&model::Message::level>("level"),
             Same<&model::Message::message>("message"),
             Same<&model::Message::detail_json>("detail"),
             Same<&model::Message::source_level>("source_level"),
         })};

inline constexpr Table<ScopeReport, ScopeUpdateRow, 11> kScopeUpdatesTable = {
    "scope_updates", Writes::kInserts, ByArrival<ScopeUpdateRow>(),
    Join(kReportColumns<ScopeReport, ScopeUpdateRow>,
         std::array<Column<ScopeReport, ScopeUpdateRow>, 5>{
             Same<&model::ScopeUpdate::unix_time_ms>("sampled_ms"),
             Same<&model::ScopeUpdate::scope>("scope"),
             Same<&model::ScopeUpdate::id>("id"),
             Same<&model::ScopeUpdate::type>("type"),
             Same<&model::ScopeUpdate::detail_json>("detail"),
         })};

using OpenedRequest = Report<model::OperatorRequest>;

/// opened_at and entry are those of the record that opened the request; by its id the one is found
/// that is open.
inline constexpr Table<OpenedRequest, OperatorRequestRow, 10> kOperatorRequestsTable = {
    "operator_requests",
    Writes::kUpserts,
    {"opened_at", [](SystemTime time, OperatorRequestRow& row) { row.opened_at = time; }, "is_open",
     "closed_at"},
    std::array<Column<OpenedRequest, OperatorRequestRow>, 10>{
        kRobotRuri.Key(),
        Same("request_id", [](auto& row) { return &row.request_id; }).Key(),
        kRobotFleet,
        Col("opened_at", [](const auto& row) { return row.record->received_at; }).Kept(),
        kRowEntry.Kept(),
        Same("kind", [](auto& row) { return &row.kind; }),
        Same("text", [](auto& row) { return &row.text; }),
        Same("requested_ms", [](auto& row) { return &row.requested_at_ms; }),
        Col("is_open", [](const auto& /*row*/) { return true; }),
        Col<&OperatorRequestRow::closed_at_ms>("closed_at",
                                               [](const auto& /*row*/) { return SystemTime(); }),
    },
    "is_open"};

}  // namespace uplink::storage
