#include "tools/uplink-fleet/verify.h"

#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tools/uplink-fleet/report.h"

namespace uplink::synthetic {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr const char* kRuri = "rcan://test/robot-0001";
constexpr const char* kSession = "07000000000000000000000000000000";

model::Fault FaultOf(const std::string& description, bool active) {
  model::Fault fault;
  fault.unix_time_ms = 1000;
  fault.fault_id = "brake.wear";
  fault.source = "uplink-fleet/run1";
  fault.severity = model::FaultSeverity::kMajor;
  fault.active = active;
  fault.category = "synthetic";
  fault.description = description;
  return fault;
}

v1::Fault RowOf(const model::Fault& fault) {
  v1::Fault row;
  row.set_ruri(kRuri);
  row.set_fault_id(fault.fault_id);
  row.set_source(fault.source);
  row.set_severity("major");
  row.set_active(fault.active);
  row.set_category(fault.category);
  row.set_description(fault.description);
  row.set_sampled_at_ms(fault.unix_time_ms);
  return row;
}

/// A run in which everything went well: a fault raised, one wrong message, two live ones.
Evidence Good() {
  Evidence evidence;
  evidence.run = "run1";
  RobotOutcome robot;
  robot.ruri = kRuri;
  robot.session_hex = kSession;
  robot.last_seq = 4;
  robot.sent = 4;
  robot.all_settled = true;
  robot.ended_ok = true;
  const model::Fault fault = FaultOf("one", true);
  robot.ledger.faults["one"] = {fault, true};
  robot.ledger.active[{fault.fault_id, fault.source}] = "one";
  model::Rejection told{model::RejectReason::kMissingField, "faultId", "it is empty"};
  robot.ledger.wrongs[2] = {model::RejectReason::kMissingField, "faultId", 3, true, told};
  evidence.robots.push_back(robot);

  evidence.before.set_started_at_ms(5);
  evidence.after.set_started_at_ms(5);
  auto& uplinks = *evidence.after.mutable_uplinks();
  uplinks["received"] = 4;
  uplinks["stored"] = 1;
  uplinks["applied"] = 2;
  uplinks["rejected"] = 1;

  v1::Robot& live = evidence.live[kRuri];
  live.set_ruri(kRuri);
  live.set_presence(v1::PRESENCE_ONLINE);
  live.set_connected(true);

  StoredRobot& stored = evidence.stored[kRuri];
  stored.faults.push_back(RowOf(fault));
  stored.active_faults.push_back(RowOf(fault));
  v1::Quarantined row;
  row.set_session_id(kSession);
  row.set_seq(3);
  row.set_reason("missing_field");
  row.set_field("faultId");
  stored.quarantine.push_back(row);
  return evidence;
}

std::vector<std::string> Mismatches(const Evidence& evidence) {
  std::vector<std::string> names;
  for (const CheckRow& row : Verify(evidence)) {
    if (!row.ok) names.push_back(row.what);
  }
  return names;
}

TEST(Verify, AGoodRunAgrees) { EXPECT_THAT(Mismatches(Good()), IsEmpty()); }

TEST(Verify, AnAckedFaultThatIsNotStored) {
  Evidence evidence = Good();
  evidence.stored[kRuri].faults.clear();
  EXPECT_THAT(Mismatches(evidence), ElementsAre("faults acked"));
}

TEST(Verify, AFaultThatIsStoredTwice) {
  Evidence evidence = Good();
  auto& rows = evidence.stored[kRuri].faults;
  rows.push_back(rows[0]);
  EXPECT_THAT(Mismatches(evidence), ::testing::Contains("faults stored twice"));
}

TEST(Verify, AnUnackedFaultMayBeStoredOnce) {
  Evidence evidence = Good();
  evidence.robots[0].ledger.faults["one"].acked = false;
  EXPECT_THAT(Mismatches(evidence), IsEmpty());
  auto& rows = evidence.stored[kRuri].faults;
  rows.push_back(rows[0]);
  EXPECT_THAT(Mismatches(evidence), ::testing::Contains("faults stored twice"));
}

TEST(Verify, AFaultWhoseContentChanged) {
  for (const auto change : {+[](v1::Fault& row) { row.set_severity("minor"); },
                            +[](v1::Fault& row) { row.set_sampled_at_ms(1001); },
                            +[](v1::Fault& row) { row.set_active(false); },
                            +[](v1::Fault& row) { row.set_category(""); }}) {
    Evidence evidence = Good();
    change(evidence.stored[kRuri].faults[0]);
    EXPECT_THAT(Mismatches(evidence), ElementsAre("faults equal in content"));
  }
}

TEST(Verify, AFaultThatNobodyReported) {
  Evidence evidence = Good();
  evidence.stored[kRuri].faults.push_back(RowOf(FaultOf("two", true)));
  EXPECT_THAT(Mismatches(evidence), ::testing::Contains("faults never reported"));
}

TEST(Verify, RowsOfOtherRunsAreLeftOut) {
  Evidence evidence = Good();
  v1::Fault row = RowOf(FaultOf("two", true));
  row.set_source("uplink-fleet/run0");
  evidence.stored[kRuri].faults.push_back(row);
  evidence.stored[kRuri].active_faults.push_back(row);
  v1::Quarantined quarantined;
  quarantined.set_session_id("08000000000000000000000000000000");
  evidence.stored[kRuri].quarantine.push_back(quarantined);
  EXPECT_THAT(Mismatches(evidence), IsEmpty());
}

TEST(Verify, AnActiveFaultThatWasTakenBack) {
  Evidence evidence = Good();
  evidence.robots[0].ledger.active.clear();
  EXPECT_THAT(Mismatches(evidence), ElementsAre("active faults"));
}

TEST(Verify, AWrongMessageThatIsNotInQuarantine) {
  Evidence evidence = Good();
  evidence.stored[kRuri].quarantine.clear();
  EXPECT_THAT(Mismatches(evidence), ElementsAre("wrong on purpose, in quarantine"));
}

TEST(Verify, AGoodMessageInQuarantine) {
  Evidence evidence = Good();
  auto& rows = evidence.stored[kRuri].quarantine;
  rows.push_back(rows[0]);
  rows.back().set_seq(4);
  EXPECT_THAT(Mismatches(evidence), ElementsAre("wrong on purpose, in quarantine"));
}

TEST(Verify, AWrongMessageThatWasAckedWithoutAReject) {
  Evidence evidence = Good();
  evidence.robots[0].ledger.wrongs[2].told.reset();
  EXPECT_THAT(Mismatches(evidence), ElementsAre("wrong on purpose, told before the ack"));
}

TEST(Verify, ARejectWithAnotherField) {
  Evidence evidence = Good();
  evidence.robots[0].ledger.wrongs[2].told->field = "description";
  EXPECT_THAT(Mismatches(evidence), ElementsAre("wrong on purpose, told before the ack"));
}

TEST(Verify, ARobotThatIsNotOnline) {
  Evidence evidence = Good();
  evidence.live[kRuri].set_presence(v1::PRESENCE_UNKNOWN);
  EXPECT_THAT(Mismatches(evidence), ElementsAre("robots online"));
}

TEST(Verify, AMotionThatIsNotTheLast) {
  Evidence evidence = Good();
  model::MotionTelemetry motion;
  motion.unix_time_ms = 7;
  motion.pose = model::Pose{47, 8, 400, 90};
  motion.velocity = model::VelTwist{1.5F, 0.25F};
  motion.gps_fix_type = model::GpsFixType::kFixedRtk;
  evidence.robots[0].ledger.last_motion = motion;
  auto& live = *evidence.live[kRuri].mutable_motion()->mutable_fields();
  live["unixTimeMs"].set_number_value(7);
  auto& pose = *live["pose"].mutable_struct_value()->mutable_fields();
  pose["latDeg"].set_number_value(47);
  pose["lonDeg"].set_number_value(8);
  pose["altitudeM"].set_number_value(400);
  pose["headingDeg"].set_number_value(90);
  auto& velocity = *live["velocity"].mutable_struct_value()->mutable_fields();
  velocity["linearMps"].set_number_value(1.5);
  velocity["angularRps"].set_number_value(0.25);
  live["gpsFixType"].set_string_value("fixedRtk");
  live["gpsSource"].set_string_value("real");
  EXPECT_THAT(Mismatches(evidence), IsEmpty());
  live["unixTimeMs"].set_number_value(6);
  EXPECT_THAT(Mismatches(evidence), ElementsAre("last motion and status equal"));
}

TEST(Verify, ConservationMustHold) {
  Evidence evidence = Good();
  (*evidence.after.mutable_uplinks())["applied"] = 1;
  EXPECT_THAT(Mismatches(evidence),
              ElementsAre("conservation: received = the rest", "live, applied or superseded"));
}

TEST(Verify, CountersAreComparedFromWhereTheyStood) {
  Evidence evidence = Good();
  (*evidence.before.mutable_uplinks())["received"] = 100;
  (*evidence.before.mutable_uplinks())["stored"] = 100;
  (*evidence.after.mutable_uplinks())["received"] = 104;
  (*evidence.after.mutable_uplinks())["stored"] = 101;
  EXPECT_THAT(Mismatches(evidence), IsEmpty());
}

TEST(Verify, RepeatsCountOnlyWhenNothingDisturbedTheStreams) {
  Evidence evidence = Good();
  evidence.robots[0].sent = 5;
  EXPECT_THAT(Mismatches(evidence), ElementsAre("messages with repeats"));
  evidence.disturbed = true;
  EXPECT_THAT(Mismatches(evidence), IsEmpty());
}

TEST(Verify, AfterARestartOnlyRowsAndAcksCount) {
  Evidence evidence = Good();
  evidence.after.set_started_at_ms(6);
  evidence.after.clear_uplinks();
  EXPECT_THAT(Mismatches(evidence), IsEmpty());
  evidence.stored[kRuri].faults.clear();
  EXPECT_THAT(Mismatches(evidence), ElementsAre("faults acked"));
}

TEST(Verify, WhatIsUnsettledOrBrokenIsAMismatch) {
  Evidence evidence = Good();
  evidence.robots[0].all_settled = false;
  evidence.robots[0].ended_ok = false;
  evidence.rules_broken = 1;
  evidence.live[kRuri].set_uplinks_missing(2);
  evidence.stored[kRuri].gaps.emplace_back().set_session_id(kSession);
  EXPECT_THAT(Mismatches(evidence),
              ElementsAre("robots with all settled", "streams ended OK", "protocol rules broken",
                          "numbers missing", "gaps"));
}

TEST(Report, SaysWhetherAllAgree) {
  const std::vector<CheckRow> good = Verify(Good());
  EXPECT_TRUE(AllOk(good));
  EXPECT_THAT(TextReport({}, good), HasSubstr("verification: all agree"));
  EXPECT_THAT(JsonReport({}, good), HasSubstr("\"ok\":true"));
  Evidence evidence = Good();
  evidence.stored[kRuri].faults.clear();
  const std::vector<CheckRow> bad = Verify(evidence);
  EXPECT_THAT(TextReport({}, bad), HasSubstr("\"one\" was acked but is not stored"));
  EXPECT_THAT(TextReport({}, bad), HasSubstr("verification: MISMATCH"));
  EXPECT_THAT(JsonReport({}, bad), HasSubstr("\"ok\":false"));
}

}  // namespace
}  // namespace uplink::synthetic
