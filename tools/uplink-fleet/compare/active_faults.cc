#include "tools/uplink-fleet/compare/active_faults.h"

#include <cstdint>
#include <vector>

#include <fmt/core.h>

#include "tools/uplink-fleet/robot/rows.h"
#include "tools/uplink-fleet/robot/script.h"

namespace uplink::synthetic {
namespace {

/// When the report arrived that made the fault active: the first raise since it was last clear.
std::int64_t RaisedAt(const std::vector<v1::Fault>& newest_first, const v1::Fault& fault) {
  std::int64_t raised_ms = 0;
  for (const v1::Fault& row : newest_first) {
    if (row.fault_id() != fault.fault_id() || row.source() != fault.source()) continue;
    if (!row.active()) break;
    raised_ms = row.received_at_ms();
  }
  return raised_ms;
}

}  // namespace

void CompareActiveFaults(const RobotOutcome& robot, const StoredRobot& stored,
                         const std::string& run, Findings& findings) {
  auto expected = robot.account.active();
  findings.Expect(Thing::kActiveFaults, expected.size());
  for (const v1::Fault& row : stored.active_faults) {
    if (row.source() != SourceOf(run)) continue;
    findings.Find(Thing::kActiveFaults);
    const auto known = expected.find({row.fault_id(), row.source()});
    if (known == expected.end()) {
      findings.Differ(Thing::kActiveFaults, robot.ruri, "cleared, or once", Shown(row));
      continue;
    }
    if (Canonical(Bare(row)) != Canonical(known->second)) {
      findings.Differ(Thing::kActiveFaults, robot.ruri, Shown(known->second), Shown(row));
    } else if (row.raised_at_ms() != RaisedAt(stored.faults, row)) {
      findings.Differ(Thing::kActiveFaults, robot.ruri,
                      fmt::format("raised at {}", RaisedAt(stored.faults, row)), Shown(row));
    }
    expected.erase(known);
  }
  for (const auto& [key, fault] : expected) {
    findings.Differ(Thing::kActiveFaults, robot.ruri, Shown(fault), "not active");
  }
}

}  // namespace uplink::synthetic
