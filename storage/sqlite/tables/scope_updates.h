#pragma once

#include <cstdint>

#include "schema/model/scope_update.h"
#include "storage/numbers.h"
#include "storage/rows.h"
#include "storage/sqlite/tables/report_columns.h"

// Updates of what is no robot.
namespace uplink::storage::sqlite {

using ScopeReport = Report<model::ScopeUpdate>;

inline constexpr Table<ScopeReport, ScopeUpdateRow, 11> kScopeUpdatesTable = {
    "scope_updates", Writes::kInserts, ByArrival<ScopeUpdateRow>(),
    Join(kReportColumns<ScopeReport, ScopeUpdateRow>,
         std::to_array<Column<ScopeReport, ScopeUpdateRow>>({
             {"sampled_ms", Role::kValue,
              [](Binder& to, const ScopeReport& row) { to.Int(row.body->unix_time_ms); },
              [](const Cell& cell, ScopeUpdateRow& row) { row.update.unix_time_ms = cell.Int(); }},
             {"scope", Role::kValue,
              [](Binder& to, const ScopeReport& row) {
                to.Int(static_cast<std::int64_t>(row.body->scope));
              },
              [](const Cell& cell, ScopeUpdateRow& row) {
                row.update.scope = ScopeKindOf(cell.Int());
              }},
             {"id", Role::kValue, [](Binder& to, const ScopeReport& row) { to.Text(row.body->id); },
              [](const Cell& cell, ScopeUpdateRow& row) { row.update.id = cell.Text(); }},
             {"type", Role::kValue,
              [](Binder& to, const ScopeReport& row) { to.Text(row.body->type); },
              [](const Cell& cell, ScopeUpdateRow& row) { row.update.type = cell.Text(); }},
             {"detail", Role::kValue,
              [](Binder& to, const ScopeReport& row) { to.Text(row.body->detail_json); },
              [](const Cell& cell, ScopeUpdateRow& row) { row.update.detail_json = cell.Text(); }},
         }))};

}  // namespace uplink::storage::sqlite
