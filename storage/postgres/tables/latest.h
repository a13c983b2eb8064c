#pragma once

#include "storage/numbers.h"
#include "storage/postgres/tables/report_columns.h"
#include "storage/reader.h"

// Of which the latest alone is kept, and changes of presence.
namespace uplink::storage::postgres {

struct LatestReport {
  const CommitRecord* record = nullptr;
  LatestKind kind = LatestKind::kAgentInfo;
};

/// The text of a kind of which the latest is kept.
[[nodiscard]] std::string LatestText(const model::Body& body);

inline constexpr Table<LatestReport, Unlisted, 5> kLatestTable = {
    "latest",
    Writes::kUpserts,
    {},
    std::to_array<Column<LatestReport, Unlisted>>({
        {"ruri", Type::kText, Role::kKey,
         [](Array& to, const LatestReport& row) { to.Text(row.record->robot->ruri); }},
        {"kind", Type::kInt4, Role::kKey,
         [](Array& to, const LatestReport& row) { to.Int4(static_cast<std::int32_t>(row.kind)); }},
        {"fleet", Type::kText, Role::kValue,
         [](Array& to, const LatestReport& row) { to.Text(row.record->robot->fleet); }},
        {"received_at", Type::kTime, Role::kValue,
         [](Array& to, const LatestReport& row) { to.Time(row.record->received_at); }},
        {"body", Type::kText, Role::kValue,
         [](Array& to,
            const LatestReport&
                row) { to.Text(LatestText(std::get<model::Record>(row.record->content).body())); }},
    })};

struct PresenceChange {
  const PresenceItem* item = nullptr;
  std::int32_t place = 0;
};

inline constexpr Table<PresenceChange, PresenceRow, 5> kPresenceChangesTable = {
    "presence_changes",
    Writes::kInserts,
    {"changed_at", [](SystemTime time, PresenceRow& row) { row.at = time; }},
    std::to_array<Column<PresenceChange, PresenceRow>>({
        {"ruri", Type::kText, Role::kValue,
         [](Array& to, const PresenceChange& row) { to.Text(row.item->robot->ruri); }},
        {"changed_at", Type::kTime, Role::kValue,
         [](Array& to, const PresenceChange& row) { to.Time(row.item->at); }},
        {"entry", Type::kInt4, Role::kValue,
         [](Array& to, const PresenceChange& row) { to.Int4(row.place); }, std::nullopt,
         kEntryOfPlace},
        {"fleet", Type::kText, Role::kValue,
         [](Array& to, const PresenceChange& row) { to.Text(row.item->robot->fleet); }},
        {"presence", Type::kInt4, Role::kValue,
         [](Array& to, const PresenceChange& row) {
           to.Int4(static_cast<std::int32_t>(row.item->presence));
         },
         [](const Cell& cell, PresenceRow& row) { row.presence = PresenceOf(cell.Int()); }},
    })};

inline constexpr Table<const PresenceItem*, Unlisted, 3> kLatestPresenceTable = {
    "presence_latest",
    Writes::kUpserts,
    {},
    std::to_array<Column<const PresenceItem*, Unlisted>>({
        {"ruri", Type::kText, Role::kKey,
         [](Array& to, const PresenceItem* const& item) { to.Text(item->robot->ruri); }},
        {"presence", Type::kInt4, Role::kValue,
         [](Array& to, const PresenceItem* const& item) {
           to.Int4(static_cast<std::int32_t>(item->presence));
         }},
        {"changed_at", Type::kTime, Role::kValue,
         [](Array& to, const PresenceItem* const& item) { to.Time(item->at); }},
    })};

}  // namespace uplink::storage::postgres
