#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>

#include "schema/model/ids.h"
#include "storage/live_row.h"
#include "storage/tables/table.h"

// The checkpoint of live state, one row per robot.
namespace uplink::storage {

[[nodiscard]] inline std::optional<Bytes> PartOf(const LiveRow& row, LivePart part) {
  const std::optional<std::string>& bytes = row.parts[static_cast<std::size_t>(part)];
  if (!bytes) return std::nullopt;
  return Bytes{*bytes};
}

/// What a checkpoint leaves out stays.
#define UPLINK_LIVE_COLUMN(name, get) \
  Col(name, get).Updated("coalesce(excluded." name ", t." name ")")
#define UPLINK_PART(Part, column, view, Message, keys_max) \
  UPLINK_LIVE_COLUMN(#column, [](const auto& row) { return PartOf(row, LivePart::k##Part); }),
inline constexpr Table<LiveRow, Unlisted, kLivePartKinds + 6> kLiveTable = {
    "live",
    Writes::kUpserts,
    {},
    std::array<Column<LiveRow, Unlisted>, kLivePartKinds + 6>{
        Col(
            "ruri", [](const auto& row) -> auto& { return row.ruri; })
            .Key(),
        Col("held_since", [](const auto& row) { return row.held_since; }),
        UPLINK_LIVE_COLUMN("last_sign_at", [](const auto& row) { return row.last_sign_of_life; }),
        UPLINK_LIVE_COLUMN("clock_skew_ms", [](const auto& row) { return row.clock_skew_ms; }),
        UPLINK_LIVE_PARTS(UPLINK_PART)
            UPLINK_LIVE_COLUMN("session",
                               [](const auto& row) -> std::optional<model::SessionId> {
                                 if (!row.session) return std::nullopt;
                                 return row.session->session;
                               }),
        UPLINK_LIVE_COLUMN("settled_seq",
                           [](const auto& row) -> std::optional<model::Seq> {
                             if (!row.session) return std::nullopt;
                             return row.session->settled_seq;
                           }),
    }};
#undef UPLINK_PART
#undef UPLINK_LIVE_COLUMN

/// The columns of LiveIn (storage/read_row.h), in order: all up to the session.
constexpr SqlText LiveColumns() {
  SqlText sql;
  for (const auto& column : kLiveTable.columns) {
    if (column.name == "session") break;
    sql.Add({sql.view().empty() ? std::string_view() : ", ", column.name});
  }
  return sql;
}

}  // namespace uplink::storage
