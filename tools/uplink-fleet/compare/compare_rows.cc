// The rows of the store.
#include <set>
#include <unordered_map>
#include <utility>

#include <fmt/core.h>

#include "schema/model/enum_text.h"
#include "tools/uplink-fleet/compare/compare.h"
#include "tools/uplink-fleet/robot/rows.h"
#include "tools/uplink-fleet/robot/script.h"

namespace uplink::synthetic {
namespace {

/// A history, one row a message: as many of each content as were sent.
template <typename Row>
class History {
 public:
  History(Thing thing, model::Variant variant, const RobotOutcome& robot, Findings& findings)
      : thing_(thing), robot_(robot), findings_(findings) {
    for (const SentMessage& message : robot.ledger.sent()) {
      if (message.variant != variant || message.row_hash == 0) continue;
      Expected& expected = expected_[message.row_hash];
      ++expected.sent;
      expected.acked += message.acked ? 1 : 0;
      expected.seq = message.seq;
      findings.Expect(thing, message.acked ? 1 : 0);
    }
  }

  void Take(const Row& row) {
    findings_.Find(thing_);
    if (row.ruri() != robot_.ruri) {
      findings_.Differ(thing_, robot_.ruri, "rows of this robot", Shown(row));
    }
    if (received_before_ != 0 && row.received_at_ms() > received_before_) {
      findings_.Differ(thing_, robot_.ruri, "the newest first", Shown(row));
    }
    received_before_ = row.received_at_ms();
    const auto expected = expected_.find(HashOf(Bare(row)));
    if (expected == expected_.end()) {
      findings_.Differ(thing_, robot_.ruri, "nothing like it", Shown(row));
    } else if (++expected->second.stored > expected->second.sent) {
      findings_.Differ(thing_, robot_.ruri, fmt::format("{} of it", expected->second.sent),
                       fmt::format("{}: {}", expected->second.stored, Shown(row)));
    }
  }

  void Finish() {
    for (const auto& [hash, expected] : expected_) {
      if (expected.stored >= expected.acked) continue;
      findings_.Differ(thing_, robot_.ruri, fmt::format("number {}, acked", expected.seq),
                       "no such row");
    }
  }

 private:
  struct Expected {
    std::uint64_t sent = 0;
    std::uint64_t acked = 0;
    std::uint64_t stored = 0;
    model::Seq seq = 0;
  };

  const Thing thing_;
  const RobotOutcome& robot_;
  Findings& findings_;
  std::int64_t received_before_ = 0;
  std::unordered_map<std::uint64_t, Expected> expected_;
};

template <typename Row, typename Rows>
void CompareHistory(Thing thing, model::Variant variant, const RobotOutcome& robot,
                    const Rows& rows, Findings& findings) {
  History<Row> history(thing, variant, robot, findings);
  for (const Row& row : rows) history.Take(row);
  history.Finish();
}

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

void CompareActive(const RobotOutcome& robot, const StoredRobot& stored, const std::string& run,
                   Findings& findings) {
  auto expected = robot.ledger.active();
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

std::string Difference(const RunExpectation& expected, const v1::MissionRun& row) {
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

void CompareRuns(const RobotOutcome& robot, const StoredRobot& stored, Findings& findings) {
  auto expected = robot.ledger.runs();
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
    if (const std::string differs = Difference(known->second, row); !differs.empty()) {
      findings.Differ(Thing::kMissionRuns, robot.ruri, row.run_id(), differs);
    }
    expected.erase(known);
  }
  for (const auto& [key, run] : expected) {
    findings.Differ(Thing::kMissionRuns, robot.ruri, "run " + key.second, "no such row");
  }
}

/// Shapes or objects: those that the robot left present and that had not expired when they were
/// read.
template <typename Row>
void ComparePresent(Thing thing, const RobotOutcome& robot, std::map<std::string, Row> expected,
                    const std::vector<Row>& rows, const StoredRobot& stored, Findings& findings) {
  for (const Row& row : rows) {
    if (!row.id().starts_with(robot.mark + "-")) continue;
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

void CompareQuarantine(const RobotOutcome& robot, const StoredRobot& stored, Findings& findings) {
  std::map<model::Seq, const v1::Quarantined*> rows;
  for (const v1::Quarantined& row : stored.quarantine) {
    if (row.session_id() != robot.session_hex) continue;
    findings.Find(Thing::kQuarantine);
    if (!rows.insert({row.seq(), &row}).second) {
      findings.Differ(Thing::kQuarantine, robot.ruri, fmt::format("{} once", row.seq()), "twice");
    }
  }
  for (const auto& [tag, wrong] : robot.ledger.wrongs()) {
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
      findings.Differ(Thing::kQuarantine, robot.ruri, must, "no such row");
      continue;
    }
    if (row->second->reason() != model::ToText(wrong.reason) ||
        row->second->field() != wrong.field) {
      findings.Differ(Thing::kQuarantine, robot.ruri, must,
                      fmt::format("{} \"{}\"", row->second->reason(), row->second->field()));
    }
    rows.erase(row);
  }
  if (!robot.all_settled) return;
  for (const auto& [seq, row] : rows) {
    findings.Differ(Thing::kQuarantine, robot.ruri, fmt::format("number {} was right", seq),
                    row->reason());
  }
}

}  // namespace

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
  CompareActive(robot, stored, run, findings);
  CompareRuns(robot, stored, findings);
  ComparePresent(Thing::kShapes, robot, robot.ledger.shapes(), stored.shapes, stored, findings);
  ComparePresent(Thing::kObjects, robot, robot.ledger.objects(), stored.objects, stored, findings);
  CompareQuarantine(robot, stored, findings);
  for (const v1::Gap& gap : stored.gaps) {
    if (gap.session_id() != robot.session_hex) continue;
    findings.Find(Thing::kGaps);
    findings.Differ(Thing::kGaps, robot.ruri, "none",
                    fmt::format("{} to {}", gap.first_seq(), gap.last_seq()));
  }
  if (robot.ledger.good_rejected() != 0) {
    findings.Find(Thing::kGoodRejected, robot.ledger.good_rejected());
    findings.Differ(Thing::kGoodRejected, robot.ruri, "0", robot.ledger.first_good_rejection());
  }
}

}  // namespace uplink::synthetic
