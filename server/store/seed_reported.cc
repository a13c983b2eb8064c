// What durable reports say of robots now: for their series.
#include <algorithm>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "schema/json/text.h"
#include "server/store/seed.h"

namespace uplink::store {
namespace {

/// Robots that are asked for at a time.
constexpr std::size_t kRobotsAtATime = 500;
/// Open runs that are read: ten of each of the most robots there can be, in pages.
constexpr std::uint32_t kRunsAPage = 1000;
constexpr std::size_t kRunPagesMax = 200;

void NoteInfo(const storage::LatestRow& row, fleet::Reported& reported) {
  const std::optional<double> uptime_s = json::NumberIn(row.body_json, "uptimeS");
  if (!uptime_s || *uptime_s < 0 || *uptime_s > fleet::kUptimeSMax) return;
  reported.booted_at = row.received_at - std::chrono::seconds(static_cast<std::int64_t>(*uptime_s));
}

void NoteRun(const storage::MissionRunRow& row, fleet::Reported& reported) {
  std::optional<double> progress = json::NumberIn(row.latest_json, "progressX100");
  if (progress) progress = *progress / fleet::kProgressAPercent;
  reported.open_runs.Put(fleet::RunKey(row.mission_id, row.run_id), progress);
}

/// Every open run, the last one reported last.
absl::StatusOr<std::vector<storage::MissionRunRow>> OpenRuns(storage::Reader& reader) {
  std::vector<storage::MissionRunRow> runs;
  storage::MissionsQuery query;
  query.open = true;
  query.rows.page_size = kRunsAPage;
  for (std::size_t page = 0; page < kRunPagesMax; ++page) {
    auto rows = reader.MissionRuns(query);
    if (!rows.ok()) return rows.status();
    std::ranges::move(rows->rows, std::back_inserter(runs));
    if (rows->next_token.empty()) break;
    query.rows.page_token = rows->next_token;
  }
  std::ranges::stable_sort(runs, {}, &storage::MissionRunRow::last_received_at);
  return runs;
}

}  // namespace

absl::Status Seed::RestoreReported() {
  std::map<std::string, fleet::Reported> reported;
  std::vector<std::string> ruris;
  for (const fleet::Robot* robot : fleet_.Sorted()) ruris.push_back(robot->ruri());
  std::span<const std::string> left = ruris;
  while (!left.empty()) {
    const auto rows = reader_.Latest(left.first(std::min(left.size(), kRobotsAtATime)),
                                     1U << static_cast<unsigned>(storage::LatestKind::kAgentInfo));
    if (!rows.ok()) return rows.status();
    for (const storage::LatestRow& row : rows->rows) NoteInfo(row, reported[row.ruri]);
    left = left.subspan(std::clamp<std::size_t>(rows->complete, 1, left.size()));
  }
  const auto runs = OpenRuns(reader_);
  if (!runs.ok()) return runs.status();
  for (const storage::MissionRunRow& row : *runs) NoteRun(row, reported[row.robot.ruri]);
  for (auto& [ruri, before] : reported) {
    if (fleet::Robot* robot = fleet_.Find(ruri)) robot->state.Restore(std::move(before));
  }
  return absl::OkStatus();
}

}  // namespace uplink::store
