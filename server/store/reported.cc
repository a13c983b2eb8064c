#include "server/store/reported.h"

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <optional>

#include "schema/json/text.h"

namespace uplink::store {
namespace {

/// The newest open runs that are read of one robot: its series show those that were last reported
/// (robot::kOpenRunsMax).
constexpr std::uint32_t kRunsPerRobot = 100;
static_assert(kRunsPerRobot >= robot::kOpenRunsMax);

using Reports = std::map<std::string, robot::Reported>;

void AddInfo(const storage::LatestRow& row, robot::Reported& reported) {
  reported.agent_version = json::StringIn(row.body_json, "agentVersion").value_or("");
  reported.software_version = json::StringIn(row.body_json, "softwareVersion").value_or("");
  const std::optional<double> uptime_s = json::NumberIn(row.body_json, "uptimeS");
  if (!uptime_s || *uptime_s < 0 || *uptime_s > robot::kUptimeSMax) return;
  reported.booted_at = row.received_at - std::chrono::seconds(static_cast<std::int64_t>(*uptime_s));
}

void AddRun(const storage::MissionRunRow& row, robot::Reported& reported) {
  std::optional<double> progress = json::NumberIn(row.latest_json, "progressX100");
  if (progress) progress = *progress / robot::kProgressAPercent;
  reported.open_runs.Put(robot::RunKey(row.mission_id, row.run_id), progress);
}

/// A robot's open runs, the last one reported last.
absl::Status AddRuns(const std::string& ruri, storage::Reader& reader, Reports& reports) {
  storage::MissionsQuery query;
  query.open = true;
  query.rows.ruris = {ruri};
  query.rows.page_size = kRunsPerRobot;
  auto runs = reader.MissionRuns(query);
  if (!runs.ok()) return runs.status();
  if (runs->rows.empty()) return absl::OkStatus();
  std::ranges::stable_sort(runs->rows, {}, &storage::MissionRunRow::last_received_at);
  robot::Reported& reported = reports[ruri];
  for (const storage::MissionRunRow& row : runs->rows) AddRun(row, reported);
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<std::map<std::string, robot::Reported>> ReadReported(
    std::span<const std::string> ruris, storage::Reader& reader) {
  Reports reported;
  for (std::span<const std::string> left = ruris; !left.empty();) {
    const auto rows = reader.Latest(left, storage::BitOf(storage::LatestKind::kAgentInfo));
    if (!rows.ok()) return rows.status();
    for (const storage::LatestRow& row : rows->rows) AddInfo(row, reported[row.ruri]);
    left = left.subspan(std::clamp<std::size_t>(rows->complete, 1, left.size()));
  }
  for (const std::string& ruri : ruris) {
    if (absl::Status read = AddRuns(ruri, reader, reported); !read.ok()) return read;
  }
  return reported;
}

}  // namespace uplink::store
