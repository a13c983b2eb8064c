#pragma once

#include "storage/numbers.h"
#include "storage/postgres/tables/report_columns.h"
#include "storage/quarantine_detail.h"
#include "storage/reader.h"

// What did not become a record: quarantine and gaps.
namespace uplink::storage::postgres {

struct Quarantined {
  const CommitRecord* record = nullptr;
  model::Rejection rejection;
  QuarantineDetail detail = QuarantineDetail::kAll;
  std::int32_t place = 0;

  [[nodiscard]] std::string_view Text(const std::string& text) const {
    return detail == QuarantineDetail::kBare ? std::string_view() : std::string_view(text);
  }
};

inline constexpr Table<Quarantined, QuarantineRow, 13> kQuarantineTable = {
    "quarantine", Writes::kInserts, ByArrival<QuarantineRow>(),
    Join(kReportColumns<Quarantined, QuarantineRow>,
         std::to_array<Column<Quarantined, QuarantineRow>>({
             {"reason", Type::kInt4, Role::kValue,
              [](Array& to, const Quarantined& row) {
                to.Int4(static_cast<std::int32_t>(row.rejection.reason));
              },
              [](const Cell& cell, QuarantineRow& row) {
                row.rejection.reason = ReasonOf(cell.Int());
              }},
             {"field", Type::kText, Role::kValue,
              [](Array& to, const Quarantined& row) { to.Text(row.Text(row.rejection.field)); },
              [](const Cell& cell, QuarantineRow& row) { row.rejection.field = cell.Text(); }},
             {"detail", Type::kText, Role::kValue,
              [](Array& to, const Quarantined& row) { to.Text(row.Text(row.rejection.detail)); },
              [](const Cell& cell, QuarantineRow& row) { row.rejection.detail = cell.Text(); }},
             {"payload_bytes", Type::kInt8, Role::kValue,
              [](Array& to, const Quarantined& row) { to.Int8(row.record->payload_bytes); },
              [](const Cell& cell, QuarantineRow& row) {
                row.payload_bytes = static_cast<std::uint64_t>(cell.Int());
              }},
             {"payload", Type::kBytes, Role::kValue,
              [](Array& to, const Quarantined& row) {
                if (row.detail == QuarantineDetail::kAll && !row.record->payload.empty()) {
                  to.Bytes(row.record->payload);
                } else {
                  to.Null();
                }
              },
              [](const Cell& cell, QuarantineRow& row) { row.payload = cell.Text(); }},
             {"source", Type::kInt4, Role::kValue,
              [](Array& to, const Quarantined& row) {
                to.Int4(static_cast<std::int32_t>(SourceOf(row.record->origin)));
              },
              [](const Cell& cell, QuarantineRow& row) {
                row.source = MessageSourceOf(cell.Int());
              }},
             {"topic", Type::kText, Role::kValue,
              [](Array& to, const Quarantined& row) {
                to.Text(row.detail == QuarantineDetail::kBare ? std::string_view()
                                                              : TopicOf(row.record->origin));
              },
              [](const Cell& cell, QuarantineRow& row) { row.topic = cell.Text(); }},
         }))};

/// What a batch reported of one gap.
struct Gap {
  const GapItem* first = nullptr;
  model::Seq last = 0;
  std::int32_t place = 0;
};

inline constexpr Table<Gap, GapRow, 7> kGapsTable = {
    "gaps",
    Writes::kUpserts,
    {"seen_at", [](SystemTime time, GapRow& row) { row.seen_at = time; }},
    std::to_array<Column<Gap, GapRow>>({
        {"ruri", Type::kText, Role::kKey,
         [](Array& to, const Gap& row) { to.Text(row.first->robot->ruri); }},
        {"session", Type::kUuid, Role::kKey,
         [](Array& to, const Gap& row) { to.Uuid(row.first->session); },
         [](const Cell& cell, GapRow& row) { row.session = cell.Uuid(); }},
        {"first", Type::kInt8, Role::kKey,
         [](Array& to, const Gap& row) { to.Int8(row.first->first); },
         [](const Cell& cell, GapRow& row) { row.first = static_cast<model::Seq>(cell.Int()); }},
        {"last",
         Type::kInt8,
         Role::kValue,
         [](Array& to, const Gap& row) { to.Int8(row.last); },
         [](const Cell& cell, GapRow& row) { row.last = static_cast<model::Seq>(cell.Int()); },
         {},
         "greatest(t.last, excluded.last)"},
        {"fleet", Type::kText, Role::kKept,
         [](Array& to, const Gap& row) { to.Text(row.first->robot->fleet); }},
        {"seen_at", Type::kTime, Role::kKept,
         [](Array& to, const Gap& row) { to.Time(row.first->seen_at); }},
        {"entry", Type::kInt4, Role::kKept, [](Array& to, const Gap& row) { to.Int4(row.place); },
         std::nullopt, kEntryOfPlace},
    })};

}  // namespace uplink::storage::postgres
