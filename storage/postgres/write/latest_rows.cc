#include "storage/postgres/write/latest_rows.h"

#include <algorithm>

#include "storage/postgres/tables/insert.h"

namespace uplink::storage::postgres {

void MissionRunRows::Add(const MissionReport& report) {
  const Key key = {report.record->robot->ruri, report.body->mission_id, report.body->run_id};
  const auto [run, is_new] = runs_.try_emplace(key, report);
  if (!is_new) run->second.Add(report);
}

void MissionRunRows::MoveInto(std::vector<StoreCall>& calls) const {
  std::vector<MissionRun> rows;
  rows.reserve(runs_.size());
  for (const auto& [key, run] : runs_) rows.push_back(run);
  AddInsert<kMissionRunsTable>(rows, calls);
}

void LatestRows::MoveInto(std::vector<StoreCall>& calls) const {
  std::vector<LatestReport> rows;
  rows.reserve(last_.size());
  for (const auto& [key, record] : last_) rows.push_back({record, key.second});
  AddInsert<kLatestTable>(rows, calls);
}

void PresenceRows::MoveInto(std::vector<StoreCall>& calls) const {
  AddInsert<kPresenceChangesTable>(changes_, calls);
  std::map<std::string_view, PresenceChange> last;
  for (const PresenceChange& change : changes_) last[change.item->robot->ruri] = change;
  std::vector<PresenceChange> rows;
  rows.reserve(last.size());
  for (const auto& [ruri, change] : last) rows.push_back(change);
  AddInsert<kLatestPresenceTable>(rows, calls);
}

void GapRows::Add(const GapItem& gap, std::int32_t place) {
  Gap& row = gaps_[{gap.robot->ruri, gap.session, gap.first}];
  if (row.item == nullptr) {
    row.item = &gap;
    row.entry = place;
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
