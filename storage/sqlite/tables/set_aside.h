#pragma once

#include <string>
#include <string_view>

#include "schema/model/rejection.h"
#include "storage/numbers.h"
#include "storage/quarantine_detail.h"
#include "storage/rows.h"
#include "storage/sqlite/tables/report_columns.h"

// What did not become a record: quarantine and gaps.
namespace uplink::storage::sqlite {

struct Quarantined {
  const CommitRecord* record = nullptr;
  const model::Rejection* rejection = nullptr;
  QuarantineDetail detail = QuarantineDetail::kAll;
  EntryNumber entry = 0;

  [[nodiscard]] std::string_view Text(const std::string& text) const {
    return detail == QuarantineDetail::kBare ? std::string_view() : std::string_view(text);
  }
};

inline constexpr Table<Quarantined, QuarantineRow, 13> kQuarantineTable = {
    "quarantine", Writes::kInserts, ByArrival<QuarantineRow>(),
    Join(kReportColumns<Quarantined, QuarantineRow>,
         std::to_array<Column<Quarantined, QuarantineRow>>({
             {"reason", Role::kValue,
              [](Binder& to, const Quarantined& row) {
                to.Int(static_cast<std::int64_t>(row.rejection->reason));
              },
              [](const Cell& cell, QuarantineRow& row) {
                row.rejection.reason = ReasonOf(cell.Int());
              }},
             {"field", Role::kValue,
              [](Binder& to, const Quarantined& row) { to.Text(row.Text(row.rejection->field)); },
              [](const Cell& cell, QuarantineRow& row) { row.rejection.field = cell.Text(); }},
             {"detail", Role::kValue,
              [](Binder& to, const Quarantined& row) { to.Text(row.Text(row.rejection->detail)); },
              [](const Cell& cell, QuarantineRow& row) { row.rejection.detail = cell.Text(); }},
             {"payload_bytes", Role::kValue,
              [](Binder& to, const Quarantined& row) { to.Int(row.record->payload_bytes); },
              [](const Cell& cell, QuarantineRow& row) {
                row.payload_bytes = static_cast<std::uint64_t>(cell.Int());
              }},
             {"payload", Role::kValue,
              [](Binder& to, const Quarantined& row) {
                if (row.detail == QuarantineDetail::kAll && !row.record->payload.empty()) {
                  to.Bytes(row.record->payload);
                } else {
                  to.Null();
                }
              },
              [](const Cell& cell, QuarantineRow& row) { row.payload = cell.Text(); }},
             {"source", Role::kValue,
              [](Binder& to, const Quarantined& row) {
                to.Int(static_cast<std::int64_t>(SourceOf(row.record->origin)));
              },
              [](const Cell& cell, QuarantineRow& row) {
                row.source = MessageSourceOf(cell.Int());
              }},
             {"topic", Role::kValue,
              [](Binder& to, const Quarantined& row) {
                to.Text(row.detail == QuarantineDetail::kBare ? std::string_view()
                                                              : TopicOf(row.record->origin));
              },
              [](const Cell& cell, QuarantineRow& row) { row.topic = cell.Text(); }},
         }))};

struct Gap {
  const GapItem* item = nullptr;
  EntryNumber entry = 0;
};

inline constexpr Table<Gap, GapRow, 7> kGapsTable = {
    "gaps",
    Writes::kUpserts,
    {"seen_at", [](SystemTime time, GapRow& row) { row.seen_at = time; }},
    std::to_array<Column<Gap, GapRow>>({
        {"ruri", Role::kKey, [](Binder& to, const Gap& row) { to.Text(row.item->robot->ruri); }},
        {"session", Role::kKey, [](Binder& to, const Gap& row) { to.Session(row.item->session); },
         [](const Cell& cell, GapRow& row) { row.session = cell.Session(); }},
        {"first", Role::kKey, [](Binder& to, const Gap& row) { to.Int(row.item->first); },
         [](const Cell& cell, GapRow& row) { row.first = static_cast<model::Seq>(cell.Int()); }},
        {"last",
         Role::kValue,
         [](Binder& to, const Gap& row) { to.Int(row.item->last); },
         [](const Cell& cell, GapRow& row) { row.last = static_cast<model::Seq>(cell.Int()); },
         {},
         "max(last, excluded.last)"},
        {"fleet", Role::kKept, [](Binder& to, const Gap& row) { to.Text(row.item->robot->fleet); }},
        {"seen_at", Role::kKept, [](Binder& to, const Gap& row) { to.Time(row.item->seen_at); }},
        {"entry", Role::kKept, [](Binder& to, const Gap& row) { to.Int(row.entry); }},
    })};

}  // namespace uplink::storage::sqlite
