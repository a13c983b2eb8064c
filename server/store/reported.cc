#include "server/store/reported.h"

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <iterator>
#include <optional>
#include <vector>

#include "schema/json/text.h"

namespace uplink::store {
namespace {

/// Robots that are asked for at a time.
constexpr std::size_t kRobotsAtATime = 500;
/// Open runs that are read: ten of each of the most robots there can be, in pages.
constexpr std::uint32_t kRunsPerPage = 1000;
constexpr std::size_t kRunPagesMax = 200;

void AddInfo(const storage::LatestRow& row, robot::Reported& reported) {
  const std::optional<double> uptime_s = json::NumberIn(row.body_json, "uptimeS");
  if (!uptime_s || *uptime_s < 0 || *uptime_s > robot::kUptimeSMax) return;
  reported.booted_at = row.received_at - std::chrono::seconds(static_cast<std::int64_t>(*uptime_s));
}

void AddRun(const storage::MissionRunRow& row, robot::Reported& reported) {
  std::optional<double> progress = json::NumberIn(row.latest_json, "progressX100");
  if (progress) progress = *progress / robot::kProgressAPercent;
  reported.open_runs.Put(robot::RunKey(row.mission_id, row.run_id), progress);
}

/// Every open run, the last one reported last.
absl::StatusOr<std::vector<storage::MissionRunRow>> OpenRuns(storage::Reader& reader) {
  std::vector<storage::MissionRunRow> runs;
  storage::MissionsQuery query;
  query.open = true;
  query.rows.page_size = kRunsPerPage;
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

absl::StatusOr<std::map<std::string, robot::Reported>> ReadReported(
    std::span<const std::string> ruris, storage::Reader& reader) {
  std::map<std::string, robot::Reported> reported;
  for (std::span<const std::string> left = ruris; !left.empty();) {
    const auto rows = reader.Latest(left.first(std::min(left.size(), kRobotsAtATime)),
                                    1U << static_cast<unsigned>(storage::LatestKind::kAgentInfo));
    if (!rows.ok()) return rows.status();
    for (const storage::LatestRow& row : rows->rows) AddInfo(row, reported[row.ruri]);
    left = left.subspan(std::clamp<std::size_t>(rows->complete, 1, left.size()));
  }
  const auto runs = OpenRuns(reader);
  if (!runs.ok()) return runs.status();
  for (const storage::MissionRunRow& row : *runs) AddRun(row, reported[row.robot.ruri]);
  return reported;
}

}  // namespace uplink::store
