#pragma once

#include <array>
#include <string>
#include <variant>

#include "schema/base/check.h"
#include "schema/json/text.h"
#include "storage/commit_record.h"
#include "storage/latest_kind.h"
#include "storage/presence.h"
#include "storage/rows.h"
#include "storage/tables/table.h"

// The kinds whose latest message alone is kept, and changes of presence.
namespace uplink::storage {

/// A record of such a kind.
struct LatestReport {
  const CommitRecord* record = nullptr;
  LatestKind kind = LatestKind::kAgentInfo;

  /// json::Text of the body.
  [[nodiscard]] std::string Text() const {
    const model::Body& body = std::get<model::Record>(record->content).body();
    switch (kind) {
      case LatestKind::kAgentInfo:
        return json::Text(std::get<model::AgentInfo>(body));
      case LatestKind::kSettings:
        return json::Text(std::get<model::CurrentSettings>(body));
      case LatestKind::kUiCapabilities:
        return json::Text(std::get<model::UiCapabilities>(body));
    }
    CheckFailed(__FILE__, __LINE__, "kind", "a kind whose latest message is kept");
  }
};

inline constexpr Table<LatestReport, Unlisted, 5> kLatestTable = {
    "latest",
    Writes::kUpserts,
    {},
    std::array<Column<LatestReport, Unlisted>, 5>{
        kRobotRuri.Key(),
        Col("kind", [](const auto& row) { return row.kind; }).Key(),
        kRobotFleet,
        Col("received_at", [](const auto& row) { return row.record->received_at; }),
        Col("body", [](const auto& row) { return row.Text(); }),
    }};

struct PresenceChange {
  const PresenceItem* item = nullptr;
  Entry entry;
};

inline constexpr Table<PresenceChange, PresenceRow, 6> kPresenceChangesTable = {
    "presence_changes",
    Writes::kInserts,
    {"changed_at", [](SystemTime time, PresenceRow& row) { row.at = time; }},
    std::array<Column<PresenceChange, PresenceRow>, 6>{
        kRobotRuri,
        Col("changed_at", [](const auto& row) { return row.item->at; }),
        kRowEntry,
        kRobotFleet,
        Col<&PresenceRow::presence>("presence", [](const auto& row) { return row.item->presence; }),
        Col<&PresenceRow::why>("why", [](const auto& row) { return row.item->why; }),
    }};

inline constexpr Table<PresenceChange, Unlisted, 4> kLatestPresenceTable = {
    "presence_latest",
    Writes::kUpserts,
    {},
    std::array<Column<PresenceChange, Unlisted>, 4>{
        kRobotRuri.Key(),
        Col("presence", [](const auto& row) { return row.item->presence; }),
        Col("changed_at", [](const auto& row) { return row.item->at; }),
        Col("parked_until", [](const auto& row) { return row.item->parked_until; }),
    }};

}  // namespace uplink::storage
