#pragma once

#include <array>
#include <string_view>

#include "storage/audit.h"
#include "storage/tables/table.h"

// What operators and servers changed, or tried to.
namespace uplink::storage {

/// The columns after time, entry, target and fleet. AccessStore writes the rows, no batch.
inline constexpr Table<AuditRow, AuditRow, 6> kAuditTable = {
    "audit",
    Writes::kInserts,
    {"at", [](SystemTime time, AuditRow& row) { row.at = time; }},
    std::array<Column<AuditRow, AuditRow>, 6>{
        Same("proof", [](auto& row) { return &row.proof; }),
        Same("who", [](auto& row) { return &row.who; }),
        Same("address", [](auto& row) { return &row.from; }),
        Same("action", [](auto& row) { return &row.action; }),
        Same("outcome", [](auto& row) { return &row.outcome; }),
        Same("detail", [](auto& row) { return &row.detail; }),
    }};

}  // namespace uplink::storage
