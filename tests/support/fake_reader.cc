#include "tests/support/fake_reader.h"

#include <algorithm>
#include <mutex>
#include <optional>
#include <set>
#include <utility>

#include "storage/expiry.h"
#include "storage/page_token.h"
#include "tests/support/fake_page.h"

namespace uplink::testing {
namespace {

using storage::HistoryQuery;
using storage::MissionsQuery;
using storage::Page;
using storage::PageKind;
using storage::PresentQuery;

template <typename Row>
FakePlaced<Row> Placed(const FakeEntry<Row>& entry) {
  return {{entry.at, entry.entry}, &entry.row};
}

template <typename Row>
std::vector<FakePlaced<Row>> AllOf(const std::vector<FakeEntry<Row>>& entries) {
  std::vector<FakePlaced<Row>> rows;
  rows.reserve(entries.size());
  for (const FakeEntry<Row>& entry : entries) rows.push_back(Placed(entry));
  return rows;
}

template <typename Row>
std::vector<FakePlaced<Row>> PresentOf(const FakePresent<Row>& present, const PresentQuery& query) {
  std::vector<FakePlaced<Row>> rows;
  for (const auto& [ruri, by_id] : present.robots()) {
    for (const auto& [id, entry] : by_id) {
      if (query.include_expired ||
          !storage::IsExpired(entry.row.expires_at_ms, UnixMs(query.now))) {
        rows.push_back(Placed(entry));
      }
    }
  }
  return rows;
}

template <typename Row>
bool OfMission(const Row& row, const MissionsQuery& query) {
  return (query.mission_id.empty() || query.mission_id == row.mission_id) &&
         (query.run_id.empty() || query.run_id == row.run_id) &&
         (!query.status || *query.status == row.status);
}

bool OfFault(const storage::FaultRow& row, const storage::FaultsQuery& query) {
  return (!query.severity || *query.severity == row.fault.severity) &&
         (query.fault_id.empty() || query.fault_id == row.fault.fault_id) &&
         (query.source.empty() || query.source == row.fault.source);
}

}  // namespace

absl::StatusOr<std::vector<storage::RobotRow>> FakeReader::Robots(std::uint32_t robots_max) {
  const std::lock_guard lock(database_.mutex_);
  std::vector<storage::RobotRow> rows;
  for (const auto& [ruri, robot] : database_.robots_) {
    if (robot.epoch == 0 || storage::IsNoRobot(ruri)) continue;
    storage::RobotRow& row = rows.emplace_back();
    row.robot = robot.id;
    row.first_seen = robot.first_seen;
    row.last_seen = robot.last_seen;
    row.holder = robot.owner;
    row.was_claimed = robot.claim.has_value();
    if (const auto last = database_.presence_.Last(ruri)) {
      row.last_presence = last->presence;
      row.presence_since = last->since;
      row.parked_until = last->parked_until;
    }
    // In order of their ids.
    SystemTime used;
    for (const auto& [id, session] : robot.sessions) {
      if (row.last_session && session.last_used < used) continue;
      row.last_session = {id, session.cursor};
      used = session.last_used;
    }
    if (row.last_session && robot.settled && robot.settled->session == row.last_session->session) {
      row.last_session->settled_seq =
          std::max(row.last_session->settled_seq, robot.settled->settled_seq);
    }
  }
  std::ranges::stable_sort(rows, std::greater(), &storage::RobotRow::last_seen);
  if (rows.size() > robots_max) rows.resize(robots_max);
  return rows;
}

absl::StatusOr<std::size_t> FakeReader::RobotCount() {
  const std::lock_guard lock(database_.mutex_);
  return static_cast<std::size_t>(std::ranges::count_if(database_.robots_, [](const auto& robot) {
    return robot.second.epoch != 0 && !storage::IsNoRobot(robot.first);
  }));
}

absl::StatusOr<std::vector<std::string>> FakeReader::FleetsBeyondAscii(std::uint32_t fleets_max) {
  const std::lock_guard lock(database_.mutex_);
  std::set<std::string> fleets;
  for (const auto& [ruri, robot] : database_.robots_) {
    if (robot.epoch == 0 || storage::IsNoRobot(ruri)) continue;
    const bool is_ascii = std::ranges::all_of(
        robot.id.fleet, [](char byte) { return static_cast<unsigned char>(byte) < 0x80; });
    if (!is_ascii) fleets.insert(robot.id.fleet);
  }
  std::vector<std::string> first(fleets.begin(), fleets.end());
  if (first.size() > fleets_max) first.resize(fleets_max);
  return first;
}

absl::StatusOr<Page<storage::FaultRow>> FakeReader::FaultsActive(
    const storage::FaultsQuery& query) {
  const std::lock_guard lock(database_.mutex_);
  std::vector<FakePlaced<storage::FaultRow>> rows;
  for (const auto& [ruri, robot] : database_.robots_) {
    for (const auto& [key, fault] : robot.faults_active) {
      if (OfFault(fault.row, query)) rows.push_back(Placed(fault));
    }
  }
  return FakePageOf(PageKind::kFaultsActive, query.rows, std::move(rows));
}

absl::StatusOr<Page<storage::FaultRow>> FakeReader::FaultHistory(
    const storage::FaultsQuery& query) {
  const std::lock_guard lock(database_.mutex_);
  std::vector<FakePlaced<storage::FaultRow>> rows = AllOf(database_.faults_history_);
  std::erase_if(rows, [&query](const auto& row) { return !OfFault(*row.second, query); });
  return FakePageOf(PageKind::kFaultHistory, query.rows, std::move(rows));
}

absl::StatusOr<std::vector<storage::ActiveFaults>> FakeReader::ActiveFaultCounts(
    std::span<const std::string> ruris) {
  const std::lock_guard lock(database_.mutex_);
  std::vector<storage::ActiveFaults> counts;
  for (const std::string& ruri : ruris) {
    const auto robot = database_.robots_.find(ruri);
    if (robot == database_.robots_.end() || robot->second.faults_active.empty()) continue;
    storage::ActiveFaults& faults = counts.emplace_back();
    faults.ruri = ruri;
    for (const auto& [key, fault] : robot->second.faults_active) {
      faults.Add(static_cast<std::int64_t>(fault.row.fault.severity), 1);
    }
  }
  return counts;
}

absl::StatusOr<std::vector<storage::OpenRequestCount>> FakeReader::OpenRequestCounts(
    std::span<const std::string> ruris) {
  const std::lock_guard lock(database_.mutex_);
  std::vector<storage::OpenRequestCount> counts;
  for (const std::string& ruri : ruris) {
    const auto open = std::ranges::count_if(database_.kinds_.requests(), [&ruri](const auto& row) {
      return row.row.robot.ruri == ruri && row.row.closed_at_ms == 0;
    });
    if (open > 0) counts.push_back({ruri, open});
  }
  return counts;
}

absl::StatusOr<Page<storage::QuarantineRow>> FakeReader::Quarantine(
    const storage::QuarantineQuery& query) {
  const std::lock_guard lock(database_.mutex_);
  std::vector<FakePlaced<storage::QuarantineRow>> rows = AllOf(database_.quarantine_);
  std::erase_if(rows, [&query](const auto& row) {
    return (query.source && row.second->source != *query.source) ||
           (query.reason && row.second->rejection.reason != *query.reason);
  });
  return FakePageOf(PageKind::kQuarantine, query.rows, std::move(rows));
}

absl::StatusOr<Page<storage::GapRow>> FakeReader::Gaps(const HistoryQuery& query) {
  const std::lock_guard lock(database_.mutex_);
  std::vector<FakePlaced<storage::GapRow>> rows;
  for (const auto& [ruri, robot] : database_.robots_) {
    for (const auto& [place, gap] : robot.gaps) {
      rows.push_back({{place.first, place.second}, &gap});
    }
  }
  return FakePageOf(PageKind::kGaps, query, std::move(rows));
}

absl::StatusOr<std::vector<storage::DroppedRow>> FakeReader::QuarantineDropped(
    const std::string& ruri) {
  const std::lock_guard lock(database_.mutex_);
  std::vector<storage::DroppedRow> rows;
  const auto robot = database_.robots_.find(ruri);
  if (robot == database_.robots_.end()) return rows;
  for (const auto& [reason, count] : robot->second.dropped) rows.push_back({reason, count});
  return rows;
}

absl::StatusOr<std::vector<storage::StoredReject>> FakeReader::Rejects(
    const storage::RejectsQuery& query) {
  const std::lock_guard lock(database_.mutex_);
  using Rows = std::vector<storage::StoredReject>;
  const auto robot = database_.robots_.find(query.ruri);
  if (robot == database_.robots_.end()) return Rows();
  const auto session = robot->second.sessions.find(query.session);
  if (session == robot->second.sessions.end()) return Rows();
  return session->second.rejects.Between(query.above, query.through, query.rows_max);
}

absl::StatusOr<Page<storage::EventRow>> FakeReader::Events(const storage::EventsQuery& query) {
  const std::lock_guard lock(database_.mutex_);
  std::vector<FakePlaced<storage::EventRow>> rows = AllOf(database_.kinds_.events());
  std::erase_if(rows, [&query](const auto& row) {
    return !query.kind.empty() && row.second->kind != query.kind;
  });
  return FakePageOf(PageKind::kEvents, query.rows, std::move(rows));
}

absl::StatusOr<Page<storage::MessageRow>> FakeReader::Messages(
    const storage::MessagesQuery& query) {
  const std::lock_guard lock(database_.mutex_);
  std::vector<FakePlaced<storage::MessageRow>> rows = AllOf(database_.kinds_.messages());
  std::erase_if(rows, [&query](const auto& row) {
    return query.level && row.second->message.level != *query.level;
  });
  return FakePageOf(PageKind::kMessages, query.rows, std::move(rows));
}

absl::StatusOr<Page<storage::ScopeUpdateRow>> FakeReader::ScopeUpdates(
    const storage::ScopeUpdatesQuery& query) {
  const std::lock_guard lock(database_.mutex_);
  std::vector<FakePlaced<storage::ScopeUpdateRow>> rows = AllOf(database_.kinds_.scope_updates());
  std::erase_if(rows, [&query](const auto& row) {
    const model::ScopeUpdate& update = row.second->update;
    return (query.scope && update.scope != *query.scope) ||
           (!query.id.empty() && update.id != query.id);
  });
  return FakePageOf(PageKind::kScopeUpdates, query.rows, std::move(rows));
}

absl::StatusOr<Page<storage::MissionRunRow>> FakeReader::MissionRuns(const MissionsQuery& query) {
  const std::lock_guard lock(database_.mutex_);
  std::vector<FakePlaced<storage::MissionRunRow>> rows;
  for (const auto& [key, run] : database_.kinds_.runs()) {
    if (!OfMission(run.row, query) || (query.open && !run.open())) continue;
    rows.push_back({{run.at, run.entry}, &run.row});
  }
  return FakePageOf(PageKind::kMissionRuns, query.rows, std::move(rows));
}

absl::StatusOr<Page<storage::MissionReportRow>> FakeReader::MissionReports(
    const MissionsQuery& query) {
  const std::lock_guard lock(database_.mutex_);
  std::vector<FakePlaced<storage::MissionReportRow>> rows = AllOf(database_.kinds_.reports());
  std::erase_if(rows, [&query](const auto& row) { return !OfMission(*row.second, query); });
  return FakePageOf(PageKind::kMissionReports, query.rows, std::move(rows));
}

absl::StatusOr<Page<storage::OperatorRequestRow>> FakeReader::OperatorRequests(
    const storage::OperatorRequestsQuery& query) {
  const std::lock_guard lock(database_.mutex_);
  std::vector<FakePlaced<storage::OperatorRequestRow>> rows = AllOf(database_.kinds_.requests());
  std::erase_if(rows,
                [&query](const auto& row) { return query.open && row.second->closed_at_ms != 0; });
  return FakePageOf(PageKind::kOperatorRequests, query.rows, std::move(rows));
}

absl::StatusOr<Page<storage::ConnectionRow>> FakeReader::Connections(
    const storage::ConnectionsQuery& query) {
  const std::lock_guard lock(database_.mutex_);
  std::vector<FakePlaced<storage::ConnectionRow>> rows = AllOf(database_.connections_.rows());
  std::erase_if(rows, [&query](const auto& row) {
    return (query.open && row.second->ended_at) ||
           (query.source && row.second->source != *query.source) ||
           (query.why && row.second->why != query.why);
  });
  return FakePageOf(PageKind::kConnections, query.rows, std::move(rows));
}

absl::StatusOr<Page<storage::AuditRow>> FakeReader::Audit(const storage::AuditQuery& query) {
  const std::lock_guard lock(database_.mutex_);
  std::vector<FakePlaced<storage::AuditRow>> rows = AllOf(database_.access_.audit);
  std::erase_if(rows, [&query](const auto& row) {
    return (!query.who.empty() && row.second->who != query.who) ||
           (!query.action.empty() && row.second->action != query.action) ||
           (!query.target.empty() && row.second->target != query.target);
  });
  HistoryQuery which = query.rows;
  which.robots_alone = false;
  return FakePageOf(PageKind::kAudit, which, std::move(rows));
}

absl::StatusOr<Page<storage::ShapeRow>> FakeReader::Shapes(const PresentQuery& query) {
  const std::lock_guard lock(database_.mutex_);
  return FakePageOf(PageKind::kShapes, query.rows, PresentOf(database_.kinds_.shapes(), query));
}

absl::StatusOr<Page<storage::ObjectRow>> FakeReader::Objects(const PresentQuery& query) {
  const std::lock_guard lock(database_.mutex_);
  return FakePageOf(PageKind::kObjects, query.rows, PresentOf(database_.kinds_.objects(), query));
}

absl::StatusOr<Page<storage::PresenceRow>> FakeReader::PresenceChanges(const HistoryQuery& query) {
  const std::lock_guard lock(database_.mutex_);
  return FakePageOf(PageKind::kPresenceChanges, query, AllOf(database_.presence_.changes()));
}

absl::StatusOr<FakeReader::LatestRows> FakeReader::Latest(std::span<const std::string> ruris,
                                                          storage::LatestKindSet kinds) {
  const std::lock_guard lock(database_.mutex_);
  LatestRows latest;
  std::size_t bytes = 0;
  for (const std::string& ruri : ruris) {
    for (std::uint32_t kind = 0; kind < storage::kLatestKinds; ++kind) {
      if ((kinds & (1U << kind)) == 0) continue;
      const auto row =
          database_.kinds_.latest().find({ruri, static_cast<storage::LatestKind>(kind)});
      if (row == database_.kinds_.latest().end()) continue;
      latest.rows.push_back(row->second);
      bytes += row->second.body_json.size();
    }
    ++latest.complete;
    if (bytes > storage::kPageBytesMax) break;
  }
  return latest;
}

absl::StatusOr<storage::Reader::LiveRows> FakeReader::LiveOf(std::span<const std::string> ruris) {
  const std::lock_guard lock(database_.mutex_);
  LiveRows live;
  std::size_t bytes = 0;
  for (const std::string& ruri : ruris) {
    if (bytes >= storage::kPageBytesMax) break;
    ++live.complete;
    const auto row = database_.live_.find(ruri);
    if (row == database_.live_.end()) continue;
    live.rows.push_back(row->second);
    bytes += storage::BytesOf(row->second);
  }
  return live;
}

}  // namespace uplink::testing
