#include "tools/uplink-fleet/compare/compare_rows.h"

#include <vector>

#include <fmt/core.h>

#include "tools/uplink-fleet/compare/active_faults.h"
#include "tools/uplink-fleet/compare/history.h"
#include "tools/uplink-fleet/compare/mission_runs.h"
#include "tools/uplink-fleet/compare/present.h"
#include "tools/uplink-fleet/compare/quarantine.h"
#include "tools/uplink-fleet/robot/script.h"

namespace uplink::synthetic {

void CompareRows(const RobotOutcome& robot, const StoredRobot& stored, const std::string& run,
                 Findings& findings) {
  std::vector<v1::Fault> faults;
  for (const v1::Fault& row : stored.faults) {
    if (row.source() == SourceOf(run)) faults.push_back(row);
  }
  CompareHistory<v1::Fault>(Thing::kFaultReports, model::Variant::kFault, robot, faults, findings);
  CompareHistory<v1::Event>(Thing::kEvents, model::Variant::kEventTelemetry, robot, stored.events,
                            findings);
  CompareHistory<v1::RobotMessage>(Thing::kMessages, model::Variant::kMessage, robot,
                                   stored.messages, findings);
  CompareActiveFaults(robot, stored, run, findings);
  CompareMissionRuns(robot, stored, findings);
  ComparePresent(Thing::kShapes, robot, run, robot.account.shapes(), stored.shapes, stored,
                 findings);
  ComparePresent(Thing::kObjects, robot, run, robot.account.objects(), stored.objects, stored,
                 findings);
  CompareQuarantine(robot, stored, findings);
  for (const v1::Gap& gap : stored.gaps) {
    if (gap.session_id() != robot.session_hex) continue;
    findings.Find(Thing::kGaps);
    findings.Differ(Thing::kGaps, robot.ruri, "none",
                    fmt::format("{} to {}", gap.first_seq(), gap.last_seq()));
  }
  if (robot.account.good_rejected() != 0) {
    findings.Find(Thing::kGoodRejected, robot.account.good_rejected());
    findings.Differ(Thing::kGoodRejected, robot.ruri, "0", robot.account.first_good_rejection());
  }
}

}  // namespace uplink::synthetic
