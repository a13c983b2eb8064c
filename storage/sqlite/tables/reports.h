#pragma once

#include "schema/json/text.h"
#include "schema/model/reports.h"
#include "storage/numbers.h"
#include "storage/rows.h"
#include "storage/sqlite/tables/report_columns.h"

// What robots report and what is kept as it came: events and messages.
namespace uplink::storage::sqlite {

using EventReport = Report<model::EventTelemetry>;
using MessageReport = Report<model::Message>;

inline constexpr Table<EventReport, EventRow, 9> kEventsTable = {
    "events", Writes::kInserts, ByArrival<EventRow>(),
    Join(kReportColumns<EventReport, EventRow>,
         std::to_array<Column<EventReport, EventRow>>({
             {"sampled_ms", Role::kValue,
              [](Binder& to, const EventReport& row) { to.Int(row.body->unix_time_ms); },
              [](const Cell& cell, EventRow& row) { row.sampled_at_ms = cell.Int(); }},
             {"kind", Role::kValue,
              [](Binder& to, const EventReport& row) {
                to.Text(model::EventKindText(row.body->kind));
              },
              [](const Cell& cell, EventRow& row) { row.kind = cell.Text(); }},
             {"detail", Role::kValue,
              [](Binder& to, const EventReport& row) { to.Made(json::DetailText(row.body->kind)); },
              [](const Cell& cell, EventRow& row) { row.detail_json = cell.Text(); }},
         }))};

inline constexpr Table<MessageReport, MessageRow, 10> kMessagesTable = {
    "messages", Writes::kInserts, ByArrival<MessageRow>(),
    Join(kReportColumns<MessageReport, MessageRow>,
         std::to_array<Column<MessageReport, MessageRow>>({
             {"sampled_ms", Role::kValue,
              [](Binder& to, const MessageReport& row) { to.Int(row.body->unix_time_ms); },
              [](const Cell& cell, MessageRow& row) { row.message.unix_time_ms = cell.Int(); }},
             {"level", Role::kValue,
              [](Binder& to, const MessageReport& row) { to.Int(NumberOf(row.body->level)); },
              [](const Cell& cell, MessageRow& row) {
                row.message.level = MemberOf<model::MessageLevel>(cell.Int());
              }},
             {"message", Role::kValue,
              [](Binder& to, const MessageReport& row) { to.Text(row.body->message); },
              [](const Cell& cell, MessageRow& row) { row.message.message = cell.Text(); }},
             {"detail", Role::kValue,
              [](Binder& to, const MessageReport& row) { to.Text(row.body->detail_json); },
              [](const Cell& cell, MessageRow& row) { row.message.detail_json = cell.Text(); }},
         }))};

}  // namespace uplink::storage::sqlite
