#include "server/robot/reports.h"

#include <chrono>
#include <utility>
#include <variant>

namespace uplink::robot {

bool Reports::Follows(const model::Body& report) {
  return std::holds_alternative<model::AgentInfo>(report) ||
         std::holds_alternative<model::MissionRunStatus>(report);
}

void Reports::Add(const model::Body& report, SystemTime received_at) {
  if (const auto* info = std::get_if<model::AgentInfo>(&report)) {
    reported_.agent_version = info->agent_version;
    reported_.software_version = info->software_version.value_or("");
    if (!info->uptime_s || *info->uptime_s > kUptimeSMax) return;
    reported_.booted_at =
        received_at - std::chrono::seconds(static_cast<std::int64_t>(*info->uptime_s));
  } else if (const auto* run = std::get_if<model::MissionRunStatus>(&report)) {
    if (run->status == model::MissionStatus::kError) reported_.mission_failed_at = received_at;
    std::string key = RunKey(run->mission_id, run->run_id);
    if (model::IsTerminal(run->status)) {
      reported_.open_runs.Erase(key);
      ended_runs_.Put(std::move(key), true);
      return;
    }
    ended_runs_.Erase(key);
    std::optional<double> progress;
    if (run->progress_x100) progress = *run->progress_x100 / kProgressAPercent;
    reported_.open_runs.Put(std::move(key), progress);
  }
}

void Reports::Restore(Reported before) {
  if (!reported_.booted_at) reported_.booted_at = before.booted_at;
  if (reported_.agent_version.empty() && reported_.software_version.empty()) {
    reported_.agent_version = std::move(before.agent_version);
    reported_.software_version = std::move(before.software_version);
  }
  for (const auto& [key, ended] : ended_runs_.items()) before.open_runs.Erase(key);
  reported_.open_runs.PutOnTopOf(std::move(before.open_runs));
}

}  // namespace uplink::robot
