#pragma once

#include "schema/model/reports.h"
#include "storage/numbers.h"
#include "storage/rows.h"
#include "storage/sqlite/tables/report_columns.h"
#include "storage/sqlite/tables/upserted.h"

// Faults: their history, and those that are active.
namespace uplink::storage::sqlite {

using FaultReport = Report<model::Fault>;
using RaisedFault = Upserted<model::Fault>;

/// What names a fault of a robot, and what it says beside that. In: has `body`.
template <typename In>
inline constexpr std::array<Column<In, FaultRow>, 7> kFaultColumns = {{
    {"sampled_ms", Role::kValue, [](Binder& to, const In& row) { to.Int(row.body->unix_time_ms); },
     [](const Cell& cell, FaultRow& row) { row.fault.unix_time_ms = cell.Int(); }},
    {"fault_id", Role::kKey, [](Binder& to, const In& row) { to.Text(row.body->fault_id); },
     [](const Cell& cell, FaultRow& row) { row.fault.fault_id = cell.Text(); }},
    {"source", Role::kKey, [](Binder& to, const In& row) { to.Text(row.body->source); },
     [](const Cell& cell, FaultRow& row) { row.fault.source = cell.Text(); }},
    {"severity", Role::kValue,
     [](Binder& to, const In& row) { to.Int(NumberOf(row.body->severity)); },
     [](const Cell& cell, FaultRow& row) {
       row.fault.severity = MemberOf<model::FaultSeverity>(cell.Int());
     }},
    {"category", Role::kValue, [](Binder& to, const In& row) { to.Text(row.body->category); },
     [](const Cell& cell, FaultRow& row) { row.fault.category = cell.Text(); }},
    {"description", Role::kValue, [](Binder& to, const In& row) { to.Text(row.body->description); },
     [](const Cell& cell, FaultRow& row) { row.fault.description = cell.Text(); }},
    {"suggested_action", Role::kValue,
     [](Binder& to, const In& row) { to.Text(row.body->suggested_action); },
     [](const Cell& cell, FaultRow& row) { row.fault.suggested_action = cell.Text(); }},
}};

inline constexpr Table<FaultReport, FaultRow, 14> kFaultHistoryTable = {
    "faults_history", Writes::kInserts, ByArrival<FaultRow>(),
    Join(kReportColumns<FaultReport, FaultRow>,
         Join(kFaultColumns<FaultReport>,
              std::to_array<Column<FaultReport, FaultRow>>({
                  {"active", Role::kValue,
                   [](Binder& to, const FaultReport& row) { to.Int(row.body->active ? 1 : 0); },
                   [](const Cell& cell, FaultRow& row) { row.fault.active = cell.Int() != 0; }},
              })))};

/// raised_at and entry are those of the raise that made the fault active.
inline constexpr Table<RaisedFault, FaultRow, 12> kFaultsActiveTable = {
    "faults_active",
    Writes::kUpserts,
    {"raised_at",
     [](SystemTime time, FaultRow& row) {
       row.raised_at = time;
       row.fault.active = true;
     }},
    Join(std::to_array<Column<RaisedFault, FaultRow>>({
             {"ruri", Role::kKey,
              [](Binder& to, const RaisedFault& row) { to.Text(row.record->robot->ruri); }},
             {"fleet", Role::kValue,
              [](Binder& to, const RaisedFault& row) { to.Text(row.record->robot->fleet); }},
             {"raised_at", Role::kKept,
              [](Binder& to, const RaisedFault& row) { to.Time(row.record->received_at); }},
             {"entry", Role::kKept, [](Binder& to, const RaisedFault& row) { to.Int(row.entry); }},
             {"received_at", Role::kValue,
              [](Binder& to, const RaisedFault& row) { to.Time(row.record->received_at); },
              [](const Cell& cell, FaultRow& row) { row.received_at = cell.Time(); }},
         }),
         kFaultColumns<RaisedFault>)};

}  // namespace uplink::storage::sqlite
