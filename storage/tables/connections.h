#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>

#include "storage/connection.h"
#include "storage/rows.h"
#include "storage/sql_text.h"
#include "storage/tables/table.h"

// The connections of robots.
namespace uplink::storage {

/// What a batch says last of one connection.
struct NotedConnection {
  const ConnectionItem* item = nullptr;
  Entry entry;
};

constexpr const ConnectionItem& BodyOf(const NotedConnection& row) { return *row.item; }

/// A fact of the end, written to a column of its own: NULL while the connection is open.
template <auto kFact, auto kMember>
constexpr auto OfEnd(std::string_view column) {
  return Col<kMember>(column, [](const auto& row) {
    using Fact = std::remove_cvref_t<decltype((*row.item->ended).*kFact)>;
    using Shown = std::conditional_t<std::is_same_v<Fact, std::string>, std::string_view, Fact>;
    return row.item->ended ? std::optional<Shown>((*row.item->ended).*kFact) : std::nullopt;
  });
}

/// The rows `t` that a later word of the connection updates, as Replaces. ended_why 9 is
/// ConnectionEnd::kServerEnded.
inline constexpr SqlText kReplacedConnections = {
    "t.is_open OR (t.ended_why = 9 AND (NOT excluded.is_open"
    " OR (t.process = excluded.process AND t.ended_detail = '",
    kServerEndedDetail, "')))"};
static_assert(static_cast<int>(model::ConnectionEnd::kServerEnded) == 9);

/// An end stays; one that others presumed gives way to what the connection's own process tells.
inline constexpr Table<NotedConnection, ConnectionRow, 25> kConnectionsTable = {
    "connections",
    Writes::kUpserts,
    {"began_at", [](SystemTime time, ConnectionRow& row) { row.began_at = time; }, "is_open",
     "ended_at"},
    std::array<Column<NotedConnection, ConnectionRow>, 25>{
        kRobotRuri.Key(),
        Same("id", [](auto& row) { return &row.id; }).Key(),
        Col("began_at", [](const auto& row) { return row.item->began_at; }).Kept(),
        kRowEntry.Kept(),
        kRobotFleet.Kept(),
        Same("source", [](auto& row) { return &row.source; }).Kept(),
        Same("process", [](auto& row) { return &row.process; }).Kept(),
        Same("server", [](auto& row) { return &row.server; }).Kept(),
        Same("address", [](auto& row) { return &row.address; }).Kept(),
        Same("gateway", [](auto& row) { return &row.gateway; }).Kept(),
        Same("agent_version", [](auto& row) { return &row.agent_version; }),
        Same("certificate_serial", [](auto& row) { return &row.certificate.serial; }),
        Same("certificate_sha256", [](auto& row) { return &row.certificate.sha256; }),
        Same("certificate_key_sha256", [](auto& row) { return &row.certificate.key_sha256; }),
        Same("certificate_not_after", [](auto& row) { return &row.certificate.not_after; }),
        Same("messages", [](auto& row) { return &row.messages; }),
        Same("bytes", [](auto& row) { return &row.bytes; }),
        Same("takeovers", [](auto& row) { return &row.takeovers; }),
        Col<&ConnectionRow::held_back_ms>(
            "held_back_ms",
            [](const auto& row) { return std::int64_t{row.item->held_back.count()}; }),
        Same("held_back_why", [](auto& row) { return &row.held_back_why; }),
        Col("is_open", [](const auto& row) { return !row.item->ended; }),
        OfEnd<&ConnectionEnded::at, &ConnectionRow::ended_at>("ended_at"),
        OfEnd<&ConnectionEnded::why, &ConnectionRow::why>("ended_why"),
        OfEnd<&ConnectionEnded::code, &ConnectionRow::code>("ended_code"),
        OfEnd<&ConnectionEnded::detail, &ConnectionRow::detail>("ended_detail"),
    },
    {},
    kReplacedConnections.view()};

}  // namespace uplink::storage
