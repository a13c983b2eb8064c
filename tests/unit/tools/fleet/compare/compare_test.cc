#include <functional>
#include <memory>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/view/timestamps.h"
#include "tests/unit/tools/fleet/compare/mirror.h"
#include "tools/uplink-fleet/compare/compare_live.h"
#include "tools/uplink-fleet/compare/compare_rows.h"

/// A right server agrees; one row that is missing, doubled or changed, of any kind, is found.
namespace uplink::synthetic {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// Made once: each test changes a copy of what the server shows.
const Mirror& TheMirror() {
  static const auto& mirror = *std::make_unique<Mirror>().release();
  return mirror;
}

/// The things in which the comparison finds a difference.
std::vector<Thing> Differing(const RobotOutcome& robot, const StoredRobot& stored,
                             const v1::Robot* live) {
  Findings findings;
  CompareRows(robot, stored, kRun, findings);
  CompareLive(robot, live, findings);
  ComparePresence(robot, stored, {kStartMs, TheMirror().now_ms}, findings);
  std::vector<Thing> things;
  for (std::size_t i = 0; i < kThings; ++i) {
    if (findings.Of(static_cast<Thing>(i)).differences > 0) things.push_back(static_cast<Thing>(i));
  }
  EXPECT_EQ(findings.differences_in_all() == 0, things.empty());
  return things;
}

TEST(Compare, ARobotThatIsAwayForAMomentIsNotThereYet) {
  v1::Robot here;
  here.set_presence("online");
  here.set_connected(true);
  v1::Robot between_connections = here;
  between_connections.set_connected(false);
  v1::Robot not_heard = here;
  not_heard.set_presence("unknown");
  EXPECT_TRUE(AllThere({{"a", here}, {"b", here}}, 2));
  EXPECT_FALSE(AllThere({{"a", here}, {"b", between_connections}}, 2));
  EXPECT_FALSE(AllThere({{"a", here}, {"b", not_heard}}, 2));
  EXPECT_FALSE(AllThere({{"a", here}}, 2));
  // One that an earlier run left behind.
  EXPECT_TRUE(AllThere({{"a", here}, {"b", here}, {"c", not_heard}}, 2));
}

TEST(Compare, ARobotThatSaidGoodbyeIsParkedUntilThen) {
  RobotOutcome robot;
  v1::Robot shown;
  const auto differences = [&](const v1::Robot* live) {
    Findings findings;
    CompareParked(robot, live, findings);
    return findings.Of(Thing::kParked).differences;
  };
  EXPECT_EQ(differences(&shown), 0U) << "it said none";
  robot.parked_until_ms = 5'000;
  EXPECT_EQ(differences(&shown), 1U);
  EXPECT_EQ(differences(nullptr), 1U);
  shown.mutable_parked_until()->set_seconds(5);
  EXPECT_EQ(differences(&shown), 0U);
  shown.mutable_parked_until()->set_seconds(6);
  EXPECT_EQ(differences(&shown), 1U);
}

TEST(Compare, ARightServerAgrees) {
  const Mirror& mirror = TheMirror();
  EXPECT_THAT(Differing(mirror.robot, mirror.stored, &mirror.live), IsEmpty());
}

TEST(Compare, AllKindsTakePart) {
  const StoredRobot& stored = TheMirror().stored;
  EXPECT_GT(stored.faults.size(), 10U);
  EXPECT_GT(stored.active_faults.size(), 0U);
  EXPECT_GT(stored.events.size(), 10U);
  EXPECT_GT(stored.messages.size(), 0U);
  EXPECT_GT(stored.runs.size(), 3U);
  EXPECT_GT(stored.shapes.size(), 3U);
  EXPECT_GT(stored.objects.size(), 1U);
  EXPECT_GT(stored.quarantine.size(), 20U);
  EXPECT_EQ(TheMirror().sent.size(), model::kVariants);
}

/// One list of rows, and a change to a row that no other list sees.
struct RowCase {
  const char* name;
  Thing thing;
  std::function<void(StoredRobot&)> lose;
  std::function<void(StoredRobot&)> repeat;
  std::function<void(StoredRobot&)> change;
};

template <typename Row>
RowCase CaseOf(const char* name, Thing thing, std::vector<Row> StoredRobot::*rows,
               void (*change)(Row& row)) {
  return {name, thing, [rows](StoredRobot& stored) { (stored.*rows).pop_back(); },
          [rows](StoredRobot& stored) { (stored.*rows).push_back((stored.*rows).back()); },
          [rows, change](StoredRobot& stored) { change((stored.*rows).back()); }};
}

std::vector<RowCase> RowCases() {
  return {CaseOf<v1::Fault>("faults", Thing::kFaultReports, &StoredRobot::faults,
                            [](v1::Fault& row) { row.set_severity("none"); }),
          CaseOf<v1::Fault>("active", Thing::kActiveFaults, &StoredRobot::active_faults,
                            [](v1::Fault& row) { row.set_description("other"); }),
          CaseOf<v1::Event>("events", Thing::kEvents, &StoredRobot::events,
                            [](v1::Event& row) {
                              (*row.mutable_detail()->mutable_fields())["x"].set_bool_value(true);
                            }),
          CaseOf<v1::RobotMessage>("messages", Thing::kMessages, &StoredRobot::messages,
                                   [](v1::RobotMessage& row) {
                                     view::SetTimeMs(row, &v1::RobotMessage::mutable_sampled_at, 1);
                                   }),
          CaseOf<v1::MissionRun>("runs", Thing::kMissionRuns, &StoredRobot::runs,
                                 [](v1::MissionRun& row) { row.set_name("other"); }),
          CaseOf<v1::Shape>("shapes", Thing::kShapes, &StoredRobot::shapes,
                            [](v1::Shape& row) { row.set_rev(row.rev() - 1); }),
          CaseOf<v1::TrackedObject>("objects", Thing::kObjects, &StoredRobot::objects,
                                    [](v1::TrackedObject& row) { row.set_radius_m(99); }),
          CaseOf<v1::Quarantined>("quarantine", Thing::kQuarantine, &StoredRobot::quarantine,
                                  [](v1::Quarantined& row) { row.set_field("other"); })};
}

class CompareRowsTest : public ::testing::TestWithParam<RowCase> {
 protected:
  void ExpectFound(const std::function<void(StoredRobot&)>& change) const {
    StoredRobot stored = TheMirror().stored;
    change(stored);
    EXPECT_THAT(Differing(TheMirror().robot, stored, &TheMirror().live),
                ElementsAre(GetParam().thing));
  }
};

TEST_P(CompareRowsTest, AMissingRowIsFound) { ExpectFound(GetParam().lose); }
TEST_P(CompareRowsTest, ADoubledRowIsFound) { ExpectFound(GetParam().repeat); }
TEST_P(CompareRowsTest, AChangedRowIsFound) { ExpectFound(GetParam().change); }

INSTANTIATE_TEST_SUITE_P(Kinds, CompareRowsTest, ::testing::ValuesIn(RowCases()),
                         [](const auto& param) { return std::string(param.param.name); });

struct PartCase {
  const char* name;
  Thing thing;
  google::protobuf::Struct* (v1::Robot::*part)();
};

class ComparePartsTest : public ::testing::TestWithParam<PartCase> {};

TEST_P(ComparePartsTest, AnotherValueIsFoundAndNamed) {
  v1::Robot live = TheMirror().live;
  auto& fields = *(live.*GetParam().part)()->mutable_fields();
  ASSERT_FALSE(fields.empty());
  const std::string name = fields.begin()->first;
  fields.begin()->second.set_string_value("other");
  Findings findings;
  CompareLive(TheMirror().robot, &live, findings);
  ASSERT_EQ(findings.differences_in_all(), 1U);
  EXPECT_EQ(findings.differences()[0].thing, GetParam().thing);
  EXPECT_THAT(findings.differences()[0].found, HasSubstr(name + ": \"other\""));
}

TEST_P(ComparePartsTest, APartThatIsNotThereIsFound) {
  v1::Robot live = TheMirror().live;
  (live.*GetParam().part)()->Clear();
  EXPECT_THAT(Differing(TheMirror().robot, TheMirror().stored, &live),
              ElementsAre(GetParam().thing));
}

TEST_P(ComparePartsTest, AFieldTooManyIsFound) {
  v1::Robot live = TheMirror().live;
  (*(live.*GetParam().part)()->mutable_fields())["more"].set_number_value(1);
  EXPECT_THAT(Differing(TheMirror().robot, TheMirror().stored, &live),
              ElementsAre(GetParam().thing));
}

INSTANTIATE_TEST_SUITE_P(
    Parts, ComparePartsTest,
    ::testing::Values(PartCase{"motion", Thing::kMotion, &v1::Robot::mutable_motion},
                      PartCase{"status", Thing::kStatus, &v1::Robot::mutable_status},
                      PartCase{"extras", Thing::kExtras, &v1::Robot::mutable_extras},
                      PartCase{"health", Thing::kHealth, &v1::Robot::mutable_health},
                      PartCase{"usage", Thing::kUsage, &v1::Robot::mutable_usage},
                      PartCase{"consumables", Thing::kConsumables, &v1::Robot::mutable_consumables},
                      PartCase{"directives", Thing::kDirectives, &v1::Robot::mutable_directives},
                      PartCase{"agentInfo", Thing::kAgentInfo, &v1::Robot::mutable_agent_info},
                      PartCase{"settings", Thing::kSettings, &v1::Robot::mutable_settings},
                      PartCase{"uiCapabilities", Thing::kUiCapabilities,
                               &v1::Robot::mutable_ui_capabilities}),
    [](const auto& param) { return std::string(param.param.name); });

TEST(Compare, RowsOfOtherRunsAndSessionsAreLeftOut) {
  StoredRobot stored = TheMirror().stored;
  stored.faults.push_back(stored.faults.back());
  stored.faults.back().set_source("uplink-fleet/run0");
  stored.active_faults.push_back(stored.faults.back());
  stored.runs.push_back(stored.runs.back());
  stored.runs.back().set_run_id("run0-1-run-1");
  stored.shapes.push_back(stored.shapes.back());
  stored.shapes.back().set_id("run0-1-plan");
  stored.objects.push_back(stored.objects.back());
  stored.objects.back().set_id("run0-1-marker");
  stored.quarantine.push_back(stored.quarantine.back());
  stored.quarantine.back().set_session_id("08000000000000000000000000000000");
  stored.gaps.emplace_back().set_session_id("08000000000000000000000000000000");
  EXPECT_THAT(Differing(TheMirror().robot, stored, &TheMirror().live), IsEmpty());
}

TEST(Compare, AnUnackedMessageMayBeStoredOnceAndNotTwice) {
  RobotOutcome robot = TheMirror().robot;
  const std::uint64_t tag =
      robot.account.Enter(model::Message{kStartMs, model::MessageLevel::kInfo, "late"});
  ASSERT_FALSE(robot.account.sent()[tag - 1].acked);
  StoredRobot stored = TheMirror().stored;
  EXPECT_THAT(Differing(robot, stored, &TheMirror().live), IsEmpty());
  v1::RobotMessage row;
  row.set_ruri(kRuri);
  row.set_level("info");
  row.set_message("late");
  view::SetTimeMs(row, &v1::RobotMessage::mutable_sampled_at, kStartMs);
  stored.messages.push_back(row);
  EXPECT_THAT(Differing(robot, stored, &TheMirror().live), IsEmpty());
  stored.messages.push_back(row);
  EXPECT_THAT(Differing(robot, stored, &TheMirror().live), ElementsAre(Thing::kMessages));
}

TEST(Compare, AHistoryThatIsOutOfOrderIsFound) {
  StoredRobot stored = TheMirror().stored;
  std::swap(stored.events.front(), stored.events.back());
  EXPECT_THAT(Differing(TheMirror().robot, stored, &TheMirror().live), ElementsAre(Thing::kEvents));
}

TEST(Compare, ARunWithAnotherNumberOfReportsIsFound) {
  StoredRobot stored = TheMirror().stored;
  stored.runs.back().set_updates(stored.runs.back().updates() - 1);
  EXPECT_THAT(Differing(TheMirror().robot, stored, &TheMirror().live),
              ElementsAre(Thing::kMissionUpdates));
}

TEST(Compare, AnActiveFaultWhoseFirstRaiseIsNotKeptIsFound) {
  StoredRobot stored = TheMirror().stored;
  v1::Fault& row = stored.active_faults.back();
  view::SetTimeMs(row, &v1::Fault::mutable_raised_at, view::UnixMs(row.raised_at()) + 1);
  EXPECT_THAT(Differing(TheMirror().robot, stored, &TheMirror().live),
              ElementsAre(Thing::kActiveFaults));
}

TEST(Compare, APresenceHistoryThatIsEmptyIsFound) {
  StoredRobot stored = TheMirror().stored;
  stored.presence.clear();
  EXPECT_THAT(Differing(TheMirror().robot, stored, &TheMirror().live),
              ElementsAre(Thing::kPresenceHistory));
  stored = TheMirror().stored;
  view::SetTimeMs(stored.presence.front(), &v1::PresenceChange::mutable_at, kStartMs - 1);
  EXPECT_THAT(Differing(TheMirror().robot, stored, &TheMirror().live), IsEmpty())
      << "it was online before the run began";
}

TEST(Compare, WhatHasExpiredMustBeGoneAndNotSooner) {
  StoredRobot stored = TheMirror().stored;
  std::int64_t next_ms = 0;
  Thing thing = Thing::kObjects;
  const auto look = [&](const auto& rows, Thing of) {
    for (const auto& row : rows) {
      const std::int64_t expires_ms = view::UnixMs(row.expires_at());
      if (expires_ms == 0 || (next_ms != 0 && expires_ms >= next_ms)) continue;
      next_ms = expires_ms;
      thing = of;
    }
  };
  look(stored.objects, Thing::kObjects);
  look(stored.shapes, Thing::kShapes);
  stored.read.to_ms = next_ms - 1;
  EXPECT_THAT(Differing(TheMirror().robot, stored, &TheMirror().live), IsEmpty());
  stored.read = {next_ms, next_ms};
  EXPECT_THAT(Differing(TheMirror().robot, stored, &TheMirror().live), ElementsAre(thing));
}

TEST(Compare, AWrongMessageThatWasToldNothingOrAnother) {
  RobotOutcome robot = TheMirror().robot;
  const std::uint64_t tag = robot.account.wrongs().begin()->first;
  const model::Seq seq = robot.account.wrongs().begin()->second.seq;
  robot.account.Settle({.seq = seq, .tag = tag, .rejection = std::nullopt});
  EXPECT_THAT(Differing(robot, TheMirror().stored, &TheMirror().live),
              ElementsAre(Thing::kToldBeforeAck));
  robot.account.Settle(
      {.seq = seq, .tag = tag, .rejection = model::Rejection{model::RejectReason::kStoreRefused}});
  EXPECT_THAT(Differing(robot, TheMirror().stored, &TheMirror().live),
              ElementsAre(Thing::kToldBeforeAck));
}

TEST(Compare, AGoodMessageInQuarantineOrRejected) {
  StoredRobot stored = TheMirror().stored;
  stored.quarantine.push_back(stored.quarantine.back());
  stored.quarantine.back().set_seq(1'000'000);
  EXPECT_THAT(Differing(TheMirror().robot, stored, &TheMirror().live),
              ElementsAre(Thing::kQuarantine));
  RobotOutcome robot = TheMirror().robot;
  const std::uint64_t tag = robot.account.Enter(model::AgentInfo{});
  robot.account.Settle({.seq = 9, .tag = tag, .rejection = model::Rejection{}});
  v1::Robot live = TheMirror().live;
  EXPECT_THAT(Differing(robot, TheMirror().stored, &live),
              ElementsAre(Thing::kAgentInfo, Thing::kGoodRejected));
}

TEST(Compare, GapsAndMissingNumbers) {
  StoredRobot stored = TheMirror().stored;
  stored.gaps.emplace_back().set_session_id(kSession);
  v1::Robot live = TheMirror().live;
  live.set_uplinks_missing(2);
  EXPECT_THAT(Differing(TheMirror().robot, stored, &live),
              ElementsAre(Thing::kNumbersMissing, Thing::kGaps));
}

TEST(Compare, ARobotThatIsNotOnlineOrNotListed) {
  v1::Robot live = TheMirror().live;
  live.set_presence("unknown");
  EXPECT_THAT(Differing(TheMirror().robot, TheMirror().stored, &live), ElementsAre(Thing::kOnline));
  EXPECT_THAT(Differing(TheMirror().robot, TheMirror().stored, nullptr),
              ElementsAre(Thing::kOnline));
}

TEST(Compare, APresenceHistoryThatClaimsOffline) {
  RobotOutcome robot = TheMirror().robot;
  StoredRobot stored = TheMirror().stored;
  const auto put = [&](const char* presence, std::int64_t at_ms) {
    v1::PresenceChange change;
    change.set_presence(presence);
    view::SetTimeMs(change, &v1::PresenceChange::mutable_at, at_ms);
    stored.presence.insert(stored.presence.begin(), change);
  };
  put("offline", kStartMs - 1000);
  put("online", kStartMs - 500);
  put("offline", kStartMs + 1000);
  put("online", kStartMs + 2000);
  put("offline", TheMirror().now_ms + 1);
  EXPECT_THAT(Differing(robot, stored, &TheMirror().live), ElementsAre(Thing::kPresenceHistory));
  robot.silences = 1;
  EXPECT_THAT(Differing(robot, stored, &TheMirror().live), IsEmpty())
      << "it was silent once, and what came after the run does not count";
  put("unknown", TheMirror().now_ms);
  EXPECT_THAT(Differing(robot, stored, &TheMirror().live), ElementsAre(Thing::kPresenceHistory));
}

}  // namespace
}  // namespace uplink::synthetic
