#include "tools/uplink-fleet/verify_rows.h"

#include <map>
#include <set>
#include <string_view>
#include <utility>

#include <fmt/core.h>

#include "schema/model/enum_text.h"

namespace uplink::synthetic {
namespace {

using google::protobuf::Struct;

bool SameFault(const model::Fault& sent, const v1::Fault& row) {
  return sent.fault_id == row.fault_id() && sent.source == row.source() &&
         model::EnumText(sent.severity) == row.severity() && sent.active == row.active() &&
         sent.category == row.category() && sent.description == row.description() &&
         sent.suggested_action == row.suggested_action() &&
         sent.unix_time_ms == row.sampled_at_ms();
}

void Note(RowCounts& counts, const std::string& ruri, const std::string& text) {
  if (counts.first_difference.empty()) counts.first_difference = fmt::format("{}: {}", ruri, text);
}

bool IsOfRun(const v1::Fault& row, const std::string& run) {
  return row.source() == "uplink-fleet/" + run;
}

void CompareFaults(const RobotOutcome& robot, const StoredRobot& stored, const std::string& run,
                   RowCounts& counts) {
  std::map<std::string, std::uint64_t> seen;
  for (const v1::Fault& row : stored.faults) {
    if (!IsOfRun(row, run)) continue;
    ++counts.faults_stored;
    const auto report = robot.ledger.faults.find(row.description());
    if (report == robot.ledger.faults.end() || row.ruri() != robot.ruri) {
      ++counts.faults_foreign;
      Note(counts, robot.ruri, fmt::format("\"{}\" was never reported", row.description()));
      continue;
    }
    if (++seen[row.description()] > 1) {
      ++counts.faults_doubled;
      Note(counts, robot.ruri, fmt::format("\"{}\" is stored twice", row.description()));
    } else if (SameFault(report->second.fault, row)) {
      ++counts.faults_equal;
    } else {
      Note(counts, robot.ruri, fmt::format("\"{}\" was changed", row.description()));
    }
  }
  for (const auto& [description, report] : robot.ledger.faults) {
    if (!report.acked) continue;
    ++counts.faults_acked;
    if (seen.count(description) != 0) continue;
    ++counts.faults_missing;
    Note(counts, robot.ruri, fmt::format("\"{}\" was acked but is not stored", description));
  }
}

void CompareActive(const RobotOutcome& robot, const StoredRobot& stored, const std::string& run,
                   RowCounts& counts) {
  std::map<std::pair<std::string, std::string>, std::string> active;
  for (const v1::Fault& row : stored.active_faults) {
    if (!IsOfRun(row, run)) continue;
    ++counts.active_stored;
    if (!active.insert({{row.fault_id(), row.source()}, row.description()}).second) {
      ++counts.active_wrong;
    }
  }
  counts.active_expected += robot.ledger.active.size();
  if (active != robot.ledger.active) {
    ++counts.active_wrong;
    Note(counts, robot.ruri, "the set of active faults differs");
  }
}

void CompareQuarantine(const RobotOutcome& robot, const StoredRobot& stored, RowCounts& counts) {
  std::map<model::Seq, const v1::Quarantined*> rows;
  for (const v1::Quarantined& row : stored.quarantine) {
    if (row.session_id() != robot.session_hex) continue;
    ++counts.wrongs_stored;
    if (!rows.insert({row.seq(), &row}).second) {
      ++counts.quarantine_bad;
      Note(counts, robot.ruri, fmt::format("{} is in quarantine twice", row.seq()));
    }
  }
  for (const auto& [tag, wrong] : robot.ledger.wrongs) {
    if (!wrong.acked) continue;
    ++counts.wrongs_acked;
    if (wrong.told && wrong.told->reason == wrong.reason && wrong.told->field == wrong.field) {
      ++counts.wrongs_told;
    } else {
      Note(counts, robot.ruri,
           fmt::format("{} should be told {} \"{}\" but was told {} \"{}\"", wrong.seq,
                       model::ToText(wrong.reason), wrong.field,
                       wrong.told ? model::ToText(wrong.told->reason) : "nothing",
                       wrong.told ? wrong.told->field : ""));
    }
    const auto row = rows.find(wrong.seq);
    if (row == rows.end() || row->second->reason() != model::ToText(wrong.reason) ||
        row->second->field() != wrong.field) {
      ++counts.quarantine_bad;
      Note(counts, robot.ruri,
           fmt::format("{} is not in quarantine as {}", wrong.seq, model::ToText(wrong.reason)));
    }
    if (row != rows.end()) rows.erase(row);
  }
  if (!rows.empty() && robot.all_settled) {
    counts.quarantine_bad += rows.size();
    Note(counts, robot.ruri, fmt::format("{} is in quarantine but was right", rows.begin()->first));
  }
}

/// The value at a path of names; null if there is none.
const google::protobuf::Value* At(const Struct& root,
                                  std::initializer_list<std::string_view> path) {
  const Struct* at = &root;
  const google::protobuf::Value* value = nullptr;
  for (const std::string_view name : path) {
    if (at == nullptr) return nullptr;
    const auto found = at->fields().find(std::string(name));
    if (found == at->fields().end()) return nullptr;
    value = &found->second;
    at = value->has_struct_value() ? &value->struct_value() : nullptr;
  }
  return value;
}

bool NumberIs(const Struct& root, std::initializer_list<std::string_view> path, double expected) {
  const google::protobuf::Value* const value = At(root, path);
  // The fleet sends only numbers that every format between holds exactly.
  return value != nullptr && value->has_number_value() && value->number_value() == expected;
}

bool TextIs(const Struct& root, std::initializer_list<std::string_view> path,
            const std::string& expected) {
  const google::protobuf::Value* const value = At(root, path);
  return value != nullptr && value->string_value() == expected;
}

bool BoolIs(const Struct& root, std::initializer_list<std::string_view> path, bool expected) {
  const google::protobuf::Value* const value = At(root, path);
  return value != nullptr && value->has_bool_value() && value->bool_value() == expected;
}

bool SameMotion(const model::MotionTelemetry& sent, const Struct& live) {
  return NumberIs(live, {"unixTimeMs"}, static_cast<double>(sent.unix_time_ms)) &&
         NumberIs(live, {"pose", "latDeg"}, sent.pose->lat_deg) &&
         NumberIs(live, {"pose", "lonDeg"}, sent.pose->lon_deg) &&
         NumberIs(live, {"pose", "altitudeM"}, *sent.pose->altitude_m) &&
         NumberIs(live, {"pose", "headingDeg"}, *sent.pose->heading_deg) &&
         NumberIs(live, {"velocity", "linearMps"}, *sent.velocity->linear_mps) &&
         NumberIs(live, {"velocity", "angularRps"}, *sent.velocity->angular_rps) &&
         TextIs(live, {"gpsFixType"}, model::EnumText(*sent.gps_fix_type)) &&
         TextIs(live, {"gpsSource"}, model::EnumText(sent.gps_source));
}

bool SameStatus(const model::StatusTelemetry& sent, const Struct& live) {
  return NumberIs(live, {"unixTimeMs"}, static_cast<double>(sent.unix_time_ms)) &&
         NumberIs(live, {"battery", "socPct"}, *sent.battery->soc_pct) &&
         NumberIs(live, {"battery", "voltageV"}, *sent.battery->voltage_v) &&
         TextIs(live, {"mode"}, model::EnumText(*sent.mode)) &&
         BoolIs(live, {"faulted"}, sent.faulted) &&
         BoolIs(live, {"missionActive"}, sent.mission_active) &&
         BoolIs(live, {"estop", "active"}, sent.estop->active) &&
         TextIs(live, {"status"}, *sent.status);
}

}  // namespace

void RowCounts::Add(const RowCounts& other) {
  faults_acked += other.faults_acked;
  faults_stored += other.faults_stored;
  faults_equal += other.faults_equal;
  faults_missing += other.faults_missing;
  faults_doubled += other.faults_doubled;
  faults_foreign += other.faults_foreign;
  active_expected += other.active_expected;
  active_stored += other.active_stored;
  active_wrong += other.active_wrong;
  wrongs_acked += other.wrongs_acked;
  wrongs_told += other.wrongs_told;
  wrongs_stored += other.wrongs_stored;
  quarantine_bad += other.quarantine_bad;
  gaps += other.gaps;
  if (first_difference.empty()) first_difference = other.first_difference;
}

RowCounts CompareRows(const RobotOutcome& robot, const StoredRobot& stored,
                      const std::string& run) {
  RowCounts counts;
  CompareFaults(robot, stored, run, counts);
  CompareActive(robot, stored, run, counts);
  CompareQuarantine(robot, stored, counts);
  for (const v1::Gap& gap : stored.gaps) {
    if (gap.session_id() != robot.session_hex) continue;
    ++counts.gaps;
    Note(counts, robot.ruri, fmt::format("gap {} to {}", gap.first_seq(), gap.last_seq()));
  }
  return counts;
}

std::string CompareLive(const RobotOutcome& robot, const v1::Robot& live) {
  if (robot.ledger.last_motion && !SameMotion(*robot.ledger.last_motion, live.motion())) {
    return fmt::format("{}: motion is not the last that was sent", robot.ruri);
  }
  if (robot.ledger.last_status && !SameStatus(*robot.ledger.last_status, live.status())) {
    return fmt::format("{}: status is not the last that was sent", robot.ruri);
  }
  return {};
}

}  // namespace uplink::synthetic
