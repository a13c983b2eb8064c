#include <algorithm>
#include <mutex>
#include <set>
#include <tuple>

#include "storage/bounds.h"
#include "storage/retention.h"
#include "tests/support/fake_database.h"

namespace uplink::testing {

storage::Erased FakeDatabase::Retain(SystemTime now, const storage::StoreRules& rules) {
  const std::lock_guard lock(mutex_);
  storage::Erased erased;
  if (const auto kept = storage::FirstDayKept(now, rules.retain_history)) {
    erased.rows += EraseBefore(faults_history_, *kept, storage::kRetainRowsMax) +
                   kinds_.EraseHistory(*kept) + presence_.EraseHistory(*kept);
  }
  if (const auto kept = storage::FirstDayKept(now, rules.retain_quarantine)) {
    EraseQuarantine(*kept, erased);
    erased.rows += EraseGaps(*kept);
  }
  if (const auto kept = storage::FirstDayKept(now, rules.retain_connections)) {
    erased.rows += connections_.EraseHistory(*kept);
  }
  if (const auto kept = storage::FirstDayKept(now, rules.retain_audit)) {
    erased.rows += EraseBefore(access_.audit, *kept, storage::kRetainRowsMax);
  }
  erased.more = erased.rows >= storage::kRetainRowsMax;
  return erased;
}

void FakeDatabase::EraseQuarantine(SystemTime until, storage::Erased& erased) {
  std::set<std::uint64_t> gone;
  const auto old = OldestBefore(quarantine_, until, storage::kRetainRowsMax);
  for (const auto& [at, entry] : old) gone.insert(entry);
  erased.rejects_kept += EraseQuarantineRows(gone);
  erased.rows += gone.size();
}

std::size_t FakeDatabase::EraseQuarantineRows(const std::set<std::uint64_t>& gone) {
  std::size_t kept = 0;
  for (const auto& row : quarantine_) {
    if (!gone.contains(row.entry)) continue;
    auto& sessions = robots_[row.row.robot.ruri].sessions;
    const auto session = sessions.find(row.row.session);
    if (session == sessions.end() || row.entry < session->second.first_entry) continue;
    const bool asked = row.row.source == model::MessageSource::kUplink;
    const bool unsettled = row.row.seq > session->second.settled;
    if (session->second.rejects.LoseRow(row.row.seq, asked && unsettled)) ++kept;
  }
  std::erase_if(quarantine_, [&gone](const auto& row) { return gone.contains(row.entry); });
  for (auto& [ruri, robot] : robots_) robot.payload_rows.clear();
  for (std::size_t i = 0; i < quarantine_.size(); ++i) {
    if (quarantine_[i].row.payload.empty()) continue;
    robots_[quarantine_[i].row.robot.ruri].payload_rows.push_back(i);
  }
  return kept;
}

storage::Trimmed FakeDatabase::TrimQuarantine(std::span<const std::string> ruris) {
  const std::lock_guard lock(mutex_);
  storage::Trimmed trimmed;
  for (std::size_t place = 0; place < ruris.size(); ++place) {
    Robot& robot = robots_[ruris[place]];
    std::size_t rows = 0;
    // Whether its session is kept, and its entry.
    std::vector<std::tuple<bool, std::uint64_t, model::RejectReason>> may_go;
    for (const auto& row : quarantine_) {
      if (row.row.robot.ruri != ruris[place]) continue;
      ++rows;
      const auto session = robot.sessions.find(row.row.session);
      const bool kept = session != robot.sessions.end() && row.entry >= session->second.first_entry;
      const bool asked = row.row.source == model::MessageSource::kUplink;
      if (kept && asked && row.row.seq > session->second.settled) continue;
      may_go.emplace_back(kept, row.entry, row.row.rejection.reason);
    }
    if (rows <= storage::kQuarantineRowsPerRobotMax) continue;
    std::ranges::sort(may_go);
    may_go.resize(std::min(
        {may_go.size(), rows - storage::kQuarantineRowsPerRobotMax, storage::kTrimRowsMax}));
    std::set<std::uint64_t> gone;
    for (const auto& [kept, entry, reason] : may_go) {
      gone.insert(entry);
      ++trimmed.dropped[static_cast<std::size_t>(reason)];
      ++robot.dropped[reason];
    }
    EraseQuarantineRows(gone);
    if (gone.size() == storage::kTrimRowsMax) trimmed.unfinished.push_back(place);
  }
  return trimmed;
}

std::size_t FakeDatabase::EraseGaps(SystemTime until) {
  std::vector<std::pair<GapPlace, std::string>> old;
  for (const auto& [ruri, robot] : robots_) {
    for (const auto& [place, gap] : robot.gaps) {
      if (place.first < until) old.emplace_back(place, ruri);
    }
  }
  std::ranges::sort(old);
  old.resize(std::min(old.size(), storage::kRetainRowsMax));
  for (const auto& [place, ruri] : old) {
    Robot& robot = robots_[ruri];
    const storage::GapRow& gap = robot.gaps.at(place);
    robot.gap_places.erase({gap.session, gap.first});
    robot.gaps.erase(place);
  }
  return old.size();
}

}  // namespace uplink::testing
