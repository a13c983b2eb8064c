#include "tools/uplink-fleet/compare/quarantine.h"

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include <fmt/core.h>

namespace uplink::synthetic {
namespace {

// Past the bound of a robot its oldest rows go, and are counted.
void CompareMissing(const RobotOutcome& robot, const StoredRobot& stored,
                    const std::vector<std::string>& missing, Findings& findings) {
  const bool went = static_cast<std::int64_t>(missing.size()) <= stored.quarantine_dropped;
  for (const std::string& must : missing) {
    if (went) {
      findings.Find(Thing::kQuarantine);
    } else {
      findings.Differ(Thing::kQuarantine, robot.ruri, must, "no such row");
    }
  }
}

}  // namespace

void CompareQuarantine(const RobotOutcome& robot, const StoredRobot& stored, Findings& findings) {
  std::map<model::Seq, const v1::Quarantined*> rows;
  for (const v1::Quarantined& row : stored.quarantine) {
    if (row.session_id() != robot.session_hex) continue;
    findings.Find(Thing::kQuarantine);
    if (!rows.insert({row.seq(), &row}).second) {
      findings.Differ(Thing::kQuarantine, robot.ruri, fmt::format("{} once", row.seq()), "twice");
    }
  }
  std::vector<std::string> missing;
  for (const auto& [tag, wrong] : robot.account.wrongs()) {
    if (!wrong.acked) continue;
    findings.Expect(Thing::kQuarantine);
    findings.Expect(Thing::kToldBeforeAck);
    const std::string must =
        fmt::format("number {}: {} \"{}\"", wrong.seq, model::ToText(wrong.reason), wrong.field);
    if (wrong.told && wrong.told->reason == wrong.reason && wrong.told->field == wrong.field) {
      findings.Find(Thing::kToldBeforeAck);
    } else {
      findings.Differ(Thing::kToldBeforeAck, robot.ruri, must,
                      wrong.told ? fmt::format("{} \"{}\"", model::ToText(wrong.told->reason),
                                               wrong.told->field)
                                 : "nothing");
    }
    const auto row = rows.find(wrong.seq);
    if (row == rows.end()) {
      missing.push_back(must);
      continue;
    }
    if (row->second->reason() != model::ToText(wrong.reason) ||
        row->second->field() != wrong.field) {
      findings.Differ(Thing::kQuarantine, robot.ruri, must,
                      fmt::format("{} \"{}\"", row->second->reason(), row->second->field()));
    }
    rows.erase(row);
  }
  CompareMissing(robot, stored, missing, findings);
  if (!robot.all_settled) return;
  for (const auto& [seq, row] : rows) {
    findings.Differ(Thing::kQuarantine, robot.ruri, fmt::format("number {} was right", seq),
                    row->reason());
  }
}

}  // namespace uplink::synthetic
