#pragma once

#include <string_view>

#include "storage/numbers.h"
#include "storage/reader.h"
#include "storage/rows.h"
#include "storage/sqlite/entry_number.h"
#include "storage/sqlite/tables/table.h"
#include "storage/types.h"

// Of which the latest alone is kept, and changes of presence.
namespace uplink::storage::sqlite {

struct LatestReport {
  const CommitRecord* record = nullptr;
  LatestKind kind = LatestKind::kAgentInfo;
  /// json::Text of the body; the text outlives the write.
  std::string_view body_json;
};

inline constexpr Table<LatestReport, Unlisted, 5> kLatestTable = {
    "latest",
    Writes::kUpserts,
    {},
    std::to_array<Column<LatestReport, Unlisted>>({
        {"ruri", Role::kKey,
         [](Binder& to, const LatestReport& row) { to.Text(row.record->robot->ruri); }},
        {"kind", Role::kKey,
         [](Binder& to, const LatestReport& row) { to.Int(static_cast<std::int64_t>(row.kind)); }},
        {"fleet", Role::kValue,
         [](Binder& to, const LatestReport& row) { to.Text(row.record->robot->fleet); }},
        {"received_at", Role::kValue,
         [](Binder& to, const LatestReport& row) { to.Time(row.record->received_at); }},
        {"body", Role::kValue, [](Binder& to, const LatestReport& row) { to.Text(row.body_json); }},
    })};

struct PresenceChange {
  const PresenceItem* item = nullptr;
  EntryNumber entry = 0;
};

inline constexpr Table<PresenceChange, PresenceRow, 5> kPresenceChangesTable = {
    "presence_changes",
    Writes::kInserts,
    {"changed_at", [](SystemTime time, PresenceRow& row) { row.at = time; }},
    std::to_array<Column<PresenceChange, PresenceRow>>({
        {"ruri", Role::kValue,
         [](Binder& to, const PresenceChange& row) { to.Text(row.item->robot->ruri); }},
        {"changed_at", Role::kValue,
         [](Binder& to, const PresenceChange& row) { to.Time(row.item->at); }},
        {"entry", Role::kValue, [](Binder& to, const PresenceChange& row) { to.Int(row.entry); }},
        {"fleet", Role::kValue,
         [](Binder& to, const PresenceChange& row) { to.Text(row.item->robot->fleet); }},
        {"presence", Role::kValue,
         [](Binder& to, const PresenceChange& row) {
           to.Int(static_cast<std::int64_t>(row.item->presence));
         },
         [](const Cell& cell, PresenceRow& row) { row.presence = PresenceOf(cell.Int()); }},
    })};

inline constexpr Table<PresenceItem, Unlisted, 3> kLatestPresenceTable = {
    "presence_latest",
    Writes::kUpserts,
    {},
    std::to_array<Column<PresenceItem, Unlisted>>({
        {"ruri", Role::kKey,
         [](Binder& to, const PresenceItem& item) { to.Text(item.robot->ruri); }},
        {"presence", Role::kValue,
         [](Binder& to, const PresenceItem& item) {
           to.Int(static_cast<std::int64_t>(item.presence));
         }},
        {"changed_at", Role::kValue,
         [](Binder& to, const PresenceItem& item) { to.Time(item.at); }},
    })};

}  // namespace uplink::storage::sqlite
