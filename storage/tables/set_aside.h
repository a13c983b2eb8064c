#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "schema/model/rejection.h"
#include "storage/batch.h"
#include "storage/commit_record.h"
#include "storage/origin.h"
#include "storage/rows.h"
#include "storage/tables/reports.h"
#include "storage/tables/table.h"

// What did not become a record: quarantine and gaps.
namespace uplink::storage {

/// How much of a rejected payload its row keeps: less where the database refuses more.
enum class QuarantineDetail : std::uint8_t { kAll, kWithoutPayload, kBare };

struct Quarantined {
  const CommitRecord* record = nullptr;
  model::Rejection rejection;
  QuarantineDetail detail = QuarantineDetail::kAll;
  Entry entry;

  /// The text, if its row keeps texts.
  [[nodiscard]] std::string_view Text(std::string_view text) const {
    return detail == QuarantineDetail::kBare ? std::string_view() : text;
  }
  /// NULL if the row keeps no payload, or there is none.
  [[nodiscard]] std::optional<Bytes> Payload() const {
    if (detail != QuarantineDetail::kAll || record->payload.empty()) return std::nullopt;
    return Bytes{record->payload};
  }
};

inline constexpr Table<Quarantined, QuarantineRow, 13> kQuarantineTable = {
    "quarantine", Writes::kInserts, ByArrival<QuarantineRow>(),
    Join(kReportColumns<Quarantined, QuarantineRow>,
         std::array<Column<Quarantined, QuarantineRow>, 7>{
             Same("reason", [](auto& row) { return &row.rejection.reason; }),
             Col(
                 "field", [](const auto& row) { return row.Text(row.rejection.field); },
                 [](auto& row) { return &row.rejection.field; }),
             Col(
                 "detail", [](const auto& row) { return row.Text(row.rejection.detail); },
                 [](auto& row) { return &row.rejection.detail; }),
             Col<&QuarantineRow::payload_bytes>(
                 "payload_bytes", [](const auto& row) { return row.record->payload_bytes; }),
             Col<&QuarantineRow::payload>("payload", [](const auto& row) { return row.Payload(); }),
             Col<&QuarantineRow::source>(
                 "source", [](const auto& row) { return SourceOf(row.record->origin); }),
             Col<&QuarantineRow::topic>(
                 "topic", [](const auto& row) { return row.Text(TopicOf(row.record->origin)); }),
         })};

/// A range of limited numbers, which ends with the record's.
struct Limited {
  const CommitRecord* record = nullptr;
  const LimitedRange* range = nullptr;
  Entry entry;
};

inline constexpr Table<Limited, Unlisted, 8> kKeptRejectsTable = {
    "kept_rejects",
    Writes::kUpserts,
    {},
    std::array<Column<Limited, Unlisted>, 8>{
        kRobotRuri.Key(),
        Col("session", [](const auto& row) { return row.record->session; }).Key(),
        Col("last", [](const auto& row) { return row.record->seq; }).Key(),
        Col("first", [](const auto& row) { return row.range->first; }),
        kRowEntry,
        Col("reason", [](const auto& row) { return row.range->rejection.reason; }),
        Col(
            "field", [](const auto& row) -> auto& { return row.range->rejection.field; }),
        Col(
            "detail", [](const auto& row) -> auto& { return row.range->rejection.detail; }),
    }};

/// What a batch reported of one gap.
struct Gap {
  const GapItem* item = nullptr;
  /// The greatest of its reports.
  model::Seq last = 0;
  Entry entry;
};

inline constexpr Table<Gap, GapRow, 7> kGapsTable = {
    "gaps",
    Writes::kUpserts,
    {"seen_at", [](SystemTime time, GapRow& row) { row.seen_at = time; }},
    std::array<Column<Gap, GapRow>, 7>{
        kRobotRuri.Key(),
        Col<&GapRow::session>("session", [](const auto& row) { return row.item->session; }).Key(),
        Col<&GapRow::first>("first", [](const auto& row) { return row.item->first; }).Key(),
        Same("last", [](auto& row) { return &row.last; })
            .Updated("CASE WHEN t.last < excluded.last THEN excluded.last ELSE t.last END"),
        kRobotFleet.Kept(),
        Col("seen_at", [](const auto& row) { return row.item->seen_at; }).Kept(),
        kRowEntry.Kept(),
    }};

}  // namespace uplink::storage
