#pragma once

#include "schema/model/reports.h"
#include "storage/numbers.h"
#include "storage/postgres/tables/report_columns.h"
#include "storage/postgres/tables/upserted.h"
#include "storage/reader.h"

// Faults: their history, and those that are active.
namespace uplink::storage::postgres {

using FaultReport = Report<model::Fault>;

using RaisedFault = Upserted<model::Fault>;

/// What the reported fault says beside its key. In: has `body`.
template <typename In>
inline constexpr std::array<Column<In, FaultRow>, 5> kFaultColumns = {{
    {"sampled_ms", Type::kInt8, Role::kValue,
     [](Array& to, const In& row) { to.Int8(row.body->unix_time_ms); },
     [](const Cell& cell, FaultRow& row) { row.fault.unix_time_ms = cell.Int(); }},
    {"severity", Type::kInt4, Role::kValue,
     [](Array& to, const In& row) { to.Int4(NumberOf(row.body->severity)); },
     [](const Cell& cell, FaultRow& row) {
       row.fault.severity = MemberOf<model::FaultSeverity>(cell.Int());
     }},
    {"category", Type::kText, Role::kValue,
     [](Array& to, const In& row) { to.Text(row.body->category); },
     [](const Cell& cell, FaultRow& row) { row.fault.category = cell.Text(); }},
    {"description", Type::kText, Role::kValue,
     [](Array& to, const In& row) { to.Text(row.body->description); },
     [](const Cell& cell, FaultRow& row) { row.fault.description = cell.Text(); }},
    {"suggested_action", Type::kText, Role::kValue,
     [](Array& to, const In& row) { to.Text(row.body->suggested_action); },
     [](const Cell& cell, FaultRow& row) { row.fault.suggested_action = cell.Text(); }},
}};

/// What names a fault of a robot. In: has `body`.
template <typename In>
inline constexpr std::array<Column<In, FaultRow>, 2> kFaultKeyColumns = {{
    {"fault_id", Type::kText, Role::kKey,
     [](Array& to, const In& row) { to.Text(row.body->fault_id); },
     [](const Cell& cell, FaultRow& row) { row.fault.fault_id = cell.Text(); }},
    {"source", Type::kText, Role::kKey, [](Array& to, const In& row) { to.Text(row.body->source); },
     [](const Cell& cell, FaultRow& row) { row.fault.source = cell.Text(); }},
}};

inline constexpr Table<FaultReport, FaultRow, 14> kFaultHistoryTable = {
    "faults_history", Writes::kInserts, ByArrival<FaultRow>(),
    Join(kReportColumns<FaultReport, FaultRow>,
         Join(kFaultKeyColumns<FaultReport>,
              Join(kFaultColumns<FaultReport>,
                   std::to_array<Column<FaultReport, FaultRow>>(
                       {{"active", Type::kBool, Role::kValue,
                         [](Array& to, const FaultReport& row) { to.Bool(row.body->active); },
                         [](const Cell& cell, FaultRow& row) {
                           row.fault.active = cell.Bool();
                         }}}))))};

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
             {"ruri", Type::kText, Role::kKey,
              [](Array& to, const RaisedFault& row) { to.Text(row.record->robot->ruri); }},
             {"fleet", Type::kText, Role::kValue,
              [](Array& to, const RaisedFault& row) { to.Text(row.record->robot->fleet); }},
             {"raised_at", Type::kTime, Role::kKept,
              [](Array& to, const RaisedFault& row) { to.Time(row.first_at); }},
             {"entry", Type::kInt4, Role::kKept,
              [](Array& to, const RaisedFault& row) { to.Int4(row.place); }, std::nullopt,
              kEntryOfPlace},
             {"received_at", Type::kTime, Role::kValue,
              [](Array& to, const RaisedFault& row) { to.Time(row.record->received_at); },
              [](const Cell& cell, FaultRow& row) { row.received_at = cell.Time(); }},
         }),
         Join(kFaultKeyColumns<RaisedFault>, kFaultColumns<RaisedFault>))};

}  // namespace uplink::storage::postgres
