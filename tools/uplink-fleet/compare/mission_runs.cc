#include "tools/uplink-fleet/compare/mission_runs.h"

#include <cstdint>
#include <string>

#include <fmt/core.h>

#include "schema/model/enum_text.h"
#include "tools/uplink-fleet/robot/rows.h"

namespace uplink::synthetic {
namespace {

std::string WhatDiffers(const RunExpectation& expected, const v1::MissionRun& row) {
  const std::string status = model::EnumText(expected.latest.status);
  if (row.status() != status) return fmt::format("status {}, not {}", row.status(), status);
  if (row.name() != expected.name) return fmt::format("name {}", row.name());
  if (Canonical(row.latest()) != Canonical(PartOf(expected.latest))) {
    return fmt::format("latest {}", Shown(row.latest()));
  }
  if (row.first_received_at_ms() == 0 || row.first_received_at_ms() > row.last_received_at_ms()) {
    return fmt::format("first arrival {}, last {}", row.first_received_at_ms(),
                       row.last_received_at_ms());
  }
  return {};
}

}  // namespace

void CompareMissionRuns(const RobotOutcome& robot, const StoredRobot& stored, Findings& findings) {
  auto expected = robot.account.runs();
  findings.Expect(Thing::kMissionRuns, expected.size());
  for (const auto& [key, run] : expected) findings.Expect(Thing::kMissionUpdates, run.updates);
  for (const v1::MissionRun& row : stored.runs) {
    if (!row.run_id().starts_with(robot.mark + "-")) continue;
    findings.Find(Thing::kMissionRuns);
    findings.Find(Thing::kMissionUpdates, static_cast<std::uint64_t>(row.updates()));
    const auto known = expected.find({row.mission_id(), row.run_id()});
    if (known == expected.end()) {
      findings.Differ(Thing::kMissionRuns, robot.ruri, "no such run, or once", Shown(row));
      continue;
    }
    if (row.updates() != static_cast<std::int64_t>(known->second.updates)) {
      findings.Differ(Thing::kMissionUpdates, robot.ruri,
                      fmt::format("{}: {}", row.run_id(), known->second.updates),
                      fmt::format("{}", row.updates()));
    }
    if (const std::string differs = WhatDiffers(known->second, row); !differs.empty()) {
      findings.Differ(Thing::kMissionRuns, robot.ruri, row.run_id(), differs);
    }
    expected.erase(known);
  }
  for (const auto& [key, run] : expected) {
    findings.Differ(Thing::kMissionRuns, robot.ruri, "run " + key.second, "no such row");
  }
}

}  // namespace uplink::synthetic
