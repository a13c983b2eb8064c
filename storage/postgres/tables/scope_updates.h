#pragma once

#include <cstdint>

#include "schema/model/scope_update.h"
#include "storage/numbers.h"
#include "storage/postgres/tables/report_columns.h"
#include "storage/rows.h"

// Updates of what is no robot.
namespace uplink::storage::postgres {

using ScopeReport = Report<model::ScopeUpdate>;

inline constexpr Table<ScopeReport, ScopeUpdateRow, 11> kScopeUpdatesTable = {
    "scope_updates", Writes::kInserts, ByArrival<ScopeUpdateRow>(),
    Join(kReportColumns<ScopeReport, ScopeUpdateRow>,
         std::to_array<Column<ScopeReport, ScopeUpdateRow>>({
             {"sampled_ms", Type::kInt8, Role::kValue,
              [](Array& to, const ScopeReport& row) { to.Int8(row.body->unix_time_ms); },
              [](const Cell& cell, ScopeUpdateRow& row) { row.update.unix_time_ms = cell.Int(); }},
             {"scope", Type::kInt4, Role::kValue,
              [](Array& to, const ScopeReport& row) {
                to.Int4(static_cast<std::int32_t>(row.body->scope));
              },
              [](const Cell& cell, ScopeUpdateRow& row) {
                row.update.scope = ScopeKindOf(cell.Int());
              }},
             {"id", Type::kText, Role::kValue,
              [](Array& to, const ScopeReport& row) { to.Text(row.body->id); },
              [](const Cell& cell, ScopeUpdateRow& row) { row.update.id = cell.Text(); }},
             {"type", Type::kText, Role::kValue,
              [](Array& to, const ScopeReport& row) { to.Text(row.body->type); },
              [](const Cell& cell, ScopeUpdateRow& row) { row.update.type = cell.Text(); }},
             {"detail", Type::kText, Role::kValue,
              [](Array& to, const ScopeReport& row) { to.Text(row.body->detail_json); },
              [](const Cell& cell, ScopeUpdateRow& row) { row.update.detail_json = cell.Text(); }},
         }))};

}  // namespace uplink::storage::postgres
