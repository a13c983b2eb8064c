#include "tests/support/fake_reader.h"

#include <algorithm>
#include <mutex>
#include <optional>
#include <utility>

#include "storage/page_token.h"

namespace uplink::testing {
namespace {

using storage::HistoryQuery;
using storage::Page;
using storage::PageKind;
using storage::PagePosition;

template <typename Row>
using Placed = std::pair<PagePosition, const Row*>;

bool Matches(const model::RobotId& robot, SystemTime at, const HistoryQuery& query) {
  return (query.ruri.empty() || query.ruri == robot.ruri) &&
         (query.fleet.empty() || query.fleet == robot.fleet) &&
         (!query.from || at >= *query.from) && (!query.to || at <= *query.to);
}

/// The page that `query` asks for out of all rows, in whatever order they come.
template <typename Row>
absl::StatusOr<Page<Row>> PageOf(PageKind kind, const HistoryQuery& query,
                                 std::vector<Placed<Row>> rows) {
  const absl::StatusOr<std::optional<PagePosition>> start = storage::PageStart(kind, query);
  if (!start.ok()) return start.status();
  std::erase_if(rows, [&](const Placed<Row>& row) {
    return !Matches(row.second->robot, row.first.at, query) ||
           (start->has_value() && row.first >= **start);
  });
  std::ranges::sort(rows, std::ranges::greater{}, &Placed<Row>::first);
  Page<Row> page;
  const std::size_t size = std::min<std::size_t>(rows.size(), query.page_size);
  for (std::size_t i = 0; i < size; ++i) page.rows.push_back(*rows[i].second);
  if (rows.size() > size) page.next_token = EncodePageToken(kind, rows[size - 1].first);
  return page;
}

}  // namespace

absl::StatusOr<std::vector<storage::RobotRow>> FakeReader::Robots(std::uint32_t robots_max) {
  const std::lock_guard lock(database_.mutex_);
  std::vector<storage::RobotRow> rows;
  for (const auto& [ruri, robot] : database_.robots_) {
    if (rows.size() == robots_max) break;
    rows.push_back({robot.id, robot.first_seen, robot.last_seen});
  }
  return rows;
}

absl::StatusOr<Page<storage::FaultRow>> FakeReader::FaultsActive(const HistoryQuery& query) {
  const std::lock_guard lock(database_.mutex_);
  std::vector<Placed<storage::FaultRow>> rows;
  for (const auto& [ruri, robot] : database_.robots_) {
    for (const auto& [key, fault] : robot.faults_active) {
      rows.push_back({{fault.at, fault.entry}, &fault.row});
    }
  }
  return PageOf(PageKind::kFaultsActive, query, std::move(rows));
}

absl::StatusOr<Page<storage::FaultRow>> FakeReader::FaultHistory(const HistoryQuery& query) {
  const std::lock_guard lock(database_.mutex_);
  std::vector<Placed<storage::FaultRow>> rows;
  for (const auto& fault : database_.faults_history_) {
    rows.push_back({{fault.at, fault.entry}, &fault.row});
  }
  return PageOf(PageKind::kFaultHistory, query, std::move(rows));
}

absl::StatusOr<std::vector<storage::ActiveFaults>> FakeReader::ActiveFaultCounts(
    std::span<const std::string> ruris) {
  const std::lock_guard lock(database_.mutex_);
  std::vector<storage::ActiveFaults> counts;
  for (const std::string& ruri : ruris) {
    const auto robot = database_.robots_.find(ruri);
    if (robot == database_.robots_.end() || robot->second.faults_active.empty()) continue;
    counts.push_back({ruri, static_cast<std::int64_t>(robot->second.faults_active.size())});
  }
  return counts;
}

absl::StatusOr<Page<storage::QuarantineRow>> FakeReader::Quarantine(const HistoryQuery& query) {
  const std::lock_guard lock(database_.mutex_);
  std::vector<Placed<storage::QuarantineRow>> rows;
  for (const auto& item : database_.quarantine_) {
    rows.push_back({{item.at, item.entry}, &item.row});
  }
  return PageOf(PageKind::kQuarantine, query, std::move(rows));
}

absl::StatusOr<Page<storage::GapRow>> FakeReader::Gaps(const HistoryQuery& query) {
  const std::lock_guard lock(database_.mutex_);
  std::vector<Placed<storage::GapRow>> rows;
  for (const auto& [ruri, robot] : database_.robots_) {
    for (const auto& [place, gap] : robot.gaps) {
      rows.push_back({{place.first, place.second}, &gap});
    }
  }
  return PageOf(PageKind::kGaps, query, std::move(rows));
}

}  // namespace uplink::testing
