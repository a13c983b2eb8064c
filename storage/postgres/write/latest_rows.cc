#include "storage/postgres/write/latest_rows.h"

#include <algorithm>

namespace uplink::storage::postgres {

void MissionRunRows::Add(const MissionReport& report) {
  MissionRun& run =
      runs_[{report.record->robot->ruri, report.body->mission_id, report.body->run_id}];
  if (run.record == nullptr) {
    run.first_at = report.record->received_at;
    run.place = report.place;
  }
  run.last_place = report.place;
  run.record = report.record;
  run.body = report.body;
  run.latest_json = report.json;
  if (report.body->name) run.name = &*report.body->name;
  ++run.updates;
}

void MissionRunRows::MoveInto(std::vector<StoreCall>& calls) const {
  MoveSome(true, calls);
  MoveSome(false, calls);
}

void MissionRunRows::MoveSome(bool named, std::vector<StoreCall>& calls) const {
  std::vector<MissionRun> rows;
  for (const auto& [key, run] : runs_) {
    if ((run.name != nullptr) == named) rows.push_back(run);
  }
  if (rows.empty()) return;
  AddInsert<kMissionRunsTable>(rows, calls);
  calls.back().parameters.Int4(named ? 1 : 0);
}

void LatestRows::MoveInto(std::vector<StoreCall>& calls) const {
  std::vector<LatestReport> rows;
  rows.reserve(last_.size());
  for (const auto& [key, record] : last_) rows.push_back({record, key.second});
  AddInsert<kLatestTable>(rows, calls);
}

void PresenceRows::MoveInto(std::vector<StoreCall>& calls) const {
  AddInsert<kPresenceChangesTable>(changes_, calls);
  std::map<std::string_view, const PresenceItem*> last;
  for (const PresenceChange& change : changes_) {
    last[change.item->robot->ruri] = change.item;
  }
  std::vector<const PresenceItem*> rows;
  rows.reserve(last.size());
  for (const auto& [ruri, item] : last) rows.push_back(item);
  AddInsert<kLatestPresenceTable>(rows, calls);
}

void GapRows::Add(const GapItem& gap, std::int32_t place) {
  Gap& row = gaps_[{gap.robot->ruri, gap.session, gap.first}];
  if (row.first == nullptr) {
    row.first = &gap;
    row.place = place;
  }
  row.last = std::max(row.last, gap.last);
}

void GapRows::MoveInto(std::vector<StoreCall>& calls) const {
  std::vector<Gap> rows;
  rows.reserve(gaps_.size());
  for (const auto& [key, gap] : gaps_) rows.push_back(gap);
  AddInsert<kGapsTable>(rows, calls);
}

}  // namespace uplink::storage::postgres
