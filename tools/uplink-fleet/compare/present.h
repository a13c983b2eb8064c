#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "tools/uplink-fleet/compare/findings.h"
#include "tools/uplink-fleet/compare/stored_robot.h"
#include "tools/uplink-fleet/robot/account.h"
#include "tools/uplink-fleet/robot/rows.h"

namespace uplink::synthetic {

/// Shapes or objects: those that the robot left present and that had not expired when they were
/// read.
template <typename Row>
void ComparePresent(Thing thing, const RobotOutcome& robot, const std::string& run,
                    std::map<std::string, Row> expected, const std::vector<Row>& rows,
                    const StoredRobot& stored, Findings& findings) {
  for (const Row& row : rows) {
    // Some ids are those of several robots; all begin with the run.
    if (!row.id().starts_with(run + "-")) continue;
    findings.Find(thing);
    const auto known = expected.find(row.id());
    if (known == expected.end()) {
      findings.Differ(thing, robot.ruri, "deleted, or once", Shown(row));
      continue;
    }
    Row found = Bare(row);
    // One that names no expiry lives as long as the server lets it.
    if (known->second.expires_at_ms() == 0) found.clear_expires_at_ms();
    const std::int64_t expires_ms = known->second.expires_at_ms();
    if (Canonical(found) != Canonical(known->second)) {
      findings.Differ(thing, robot.ruri, Shown(known->second), Shown(row));
    } else if (expires_ms != 0 && expires_ms <= stored.read_from_ms) {
      findings.Differ(thing, robot.ruri, "expired", Shown(row));
    }
    findings.Expect(thing);
    expected.erase(known);
  }
  for (const auto& [id, row] : expected) {
    if (row.expires_at_ms() != 0 && row.expires_at_ms() <= stored.read_to_ms) continue;
    findings.Expect(thing);
    findings.Differ(thing, robot.ruri, Shown(row), "not present");
  }
}

}  // namespace uplink::synthetic
