#include "server/robot/reports.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/manual_clock.h"

namespace uplink::robot {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::Optional;
using ::testing::Pair;

model::Body RunOf(const std::string& run, model::MissionStatus status) {
  model::MissionRunStatus body;
  body.mission_id = "m";
  body.run_id = run;
  body.status = status;
  body.progress_x100 = 5000;
  return body;
}

TEST(ReportsTest, FollowsWhatTheSeriesLookAtAlone) {
  EXPECT_TRUE(Reports::Follows(model::AgentInfo()));
  EXPECT_TRUE(Reports::Follows(model::MissionRunStatus()));
  EXPECT_FALSE(Reports::Follows(model::Fault()));
}

TEST(ReportsTest, UptimeSaysWhenTheComputerBooted) {
  const SystemTime now = testing::ManualClock().System();
  Reports reports;
  model::AgentInfo info;
  info.uptime_s = 60;
  reports.Add(info, now);
  EXPECT_EQ(reports.reported().booted_at, now - std::chrono::seconds(60));
  info.uptime_s = kUptimeSMax + 1;
  reports.Add(info, now);
  EXPECT_EQ(reports.reported().booted_at, now - std::chrono::seconds(60)) << "it has no clock";
}

TEST(ReportsTest, VersionsAreTheLastReportedAndOlderOnesAreRestoredBeforeThat) {
  Reports reports;
  Reported stored;
  stored.agent_version = "1";
  stored.software_version = "2";
  reports.Restore(stored);
  EXPECT_EQ(reports.reported().agent_version, "1");
  EXPECT_EQ(reports.reported().software_version, "2");
  reports.Add(model::AgentInfo{.agent_version = "3"}, SystemTime());
  reports.Restore(stored);
  EXPECT_EQ(reports.reported().agent_version, "3");
  EXPECT_EQ(reports.reported().software_version, "") << "the robot tells none any more";
}

TEST(ReportsTest, ARunIsOpenUntilItEnds) {
  Reports reports;
  reports.Add(RunOf("r", model::MissionStatus::kUnknown), {});
  EXPECT_THAT(reports.reported().open_runs.items(), ElementsAre(Pair("m/r", Optional(50.0))));
  reports.Add(RunOf("r", model::MissionStatus::kComplete), {});
  EXPECT_THAT(reports.reported().open_runs.items(), IsEmpty());
}

TEST(ReportsTest, TheLastRunThatFailedIsRemembered) {
  const SystemTime now = testing::ManualClock().System();
  Reports reports;
  reports.Add(RunOf("r", model::MissionStatus::kAborted), now);
  EXPECT_EQ(reports.reported().mission_failed_at, std::nullopt) << "somebody ended it";
  reports.Add(RunOf("r", model::MissionStatus::kError), now);
  reports.Add(RunOf("s", model::MissionStatus::kComplete), now + std::chrono::seconds(1));
  EXPECT_EQ(reports.reported().mission_failed_at, now);
}

TEST(ReportsTest, WhatTheStoreKnewIsTakenUnlessItEndedMeanwhile) {
  Reports reports;
  reports.Add(RunOf("ended", model::MissionStatus::kComplete), {});
  Reported before;
  before.open_runs.Put("m/ended", 10);
  before.open_runs.Put("m/open", 20);
  reports.Restore(std::move(before));
  EXPECT_THAT(reports.reported().open_runs.items(), ElementsAre(Pair("m/open", Optional(20.0))));
}

}  // namespace
}  // namespace uplink::robot
