// What a scrape shows of robots that say many names, and what it tells of it.
#include <array>
#include <optional>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/rcan/scrape.h"
#include "tests/support/kept_lines.h"
#include "tests/support/manual_clock.h"
#include "tests/support/records.h"

namespace uplink::rcan {
namespace {

using std::chrono::hours;
using std::chrono::minutes;
using std::chrono::seconds;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

using Names = std::set<std::string>;

/// What it is, whether it is online, and when it was last heard.
constexpr std::size_t kOfPresence = 3;

class RobotNamesTest : public ::testing::Test {
 protected:
  robot::Robot& Robot(const std::string& ruri) {
    const fleet::RobotPtr robot = *fleet_.FindOrAdmit({ruri, "default"});
    return *robot;
  }
  /// So many joints with one series each, from `first` on.
  void SayJoints(robot::Robot& robot, std::size_t count, std::size_t first = 0) {
    model::RcanState state;
    for (std::size_t i = first; i < first + count; ++i) {
      state.joints.push_back(
          {.joint = "j" + std::to_string(i), .position_rad = 1, .timestamp_us = 1});
    }
    robot.state.SignOfLife(clock_.Steady(), clock_.System(), {});
    robot.state.Apply(std::move(state), clock_.Steady());
  }
  /// The names of its series at a scrape half a minute later.
  Names NamesOf(const std::string& ruri) {
    clock_.Advance(seconds(30));
    std::istringstream text(*scrape_.Text(metrics::Format::kText, metrics::Coding::kPlain));
    Names names;
    for (std::string line; std::getline(text, line);) {
      if (line.find("ruri=\"" + ruri + "\"") != std::string::npos) {
        names.insert(line.substr(0, line.rfind(' ')));
      }
    }
    return names;
  }

  testing::ManualClock clock_;
  std::vector<std::string> lines_;
  log::Logger logger_{std::make_unique<testing::KeptLines>(lines_), clock_, log::Format::kText,
                      log::Level::kInfo};
  fleet::Fleet fleet_{clock_, 100, {}};
  config::RcanConfig config_;
  view::FaultCounts faults_{clock_};
  RcanProbe probe_;
  RobotScrape scrape_{{clock_, fleet_, config_, faults_, probe_, logger_, {1, 2}}};
};

TEST_F(RobotNamesTest, ARobotWith512SeriesIsCompleteAtItsFirstScrape) {
  SayJoints(Robot("rcan://a"), 512 - kOfPresence);
  for (int i = 0; i < 3; ++i) EXPECT_THAT(NamesOf("rcan://a"), SizeIs(512));
  EXPECT_EQ(probe_.robots_incomplete.value(), 0);
  EXPECT_EQ(probe_.series_over_max_total.value(), 0);
  EXPECT_THAT(lines_, IsEmpty());
}

TEST_F(RobotNamesTest, OneMoreIsLeftOutAtEachScrapeCountedAndSaidOnceAnHour) {
  SayJoints(Robot("rcan://a"), 513 - kOfPresence);
  const Names first = NamesOf("rcan://a");
  EXPECT_THAT(first, SizeIs(512));
  EXPECT_EQ(NamesOf("rcan://a"), first) << "the same ones";
  EXPECT_EQ(probe_.series.value(), 512);
  EXPECT_EQ(probe_.robots_incomplete.value(), 1);
  EXPECT_EQ(probe_.robots_left_out.value(), 0);
  EXPECT_EQ(probe_.series_over_max_total.value(), 2);
  EXPECT_EQ(probe_.series_new_names_total.value(), 0);
  ASSERT_THAT(lines_, SizeIs(1));
  EXPECT_THAT(lines_.front(),
              AllOf(HasSubstr("warn rcan_series_left_out robot=rcan://a"),
                    HasSubstr("over_robot_series_max=1"), HasSubstr("over_robot_new_names_max=0")));
  clock_.Advance(hours(1));
  SayJoints(Robot("rcan://a"), 513 - kOfPresence);
  EXPECT_THAT(NamesOf("rcan://a"), SizeIs(512));
  EXPECT_THAT(lines_, SizeIs(2));
  SayJoints(Robot("rcan://a"), 512 - kOfPresence);
  EXPECT_THAT(NamesOf("rcan://a"), SizeIs(512));
  EXPECT_EQ(probe_.robots_incomplete.value(), 0) << "of the last scrape";
  EXPECT_THAT(lines_, SizeIs(2));
}

TEST_F(RobotNamesTest, OfNewNames64AreShownAndThe65thIsLeftOut) {
  robot::Robot& robot = Robot("rcan://a");
  for (std::size_t first : {0U, 256U}) {
    SayJoints(robot, 256, first);
    EXPECT_THAT(NamesOf("rcan://a"), SizeIs(256 + kOfPresence));
  }
  clock_.Advance(minutes(10));
  // From here on nothing that is said now is known, and places are there.
  SayJoints(robot, 64, 1000);
  EXPECT_THAT(NamesOf("rcan://a"), SizeIs(64 + kOfPresence)) << "in the places of the first 256";
  EXPECT_EQ(probe_.robots_incomplete.value(), 0);
  SayJoints(robot, 65, 1000);
  EXPECT_THAT(NamesOf("rcan://a"), SizeIs(64 + kOfPresence));
  EXPECT_EQ(probe_.robots_incomplete.value(), 1);
  EXPECT_EQ(probe_.series_new_names_total.value(), 1);
  EXPECT_EQ(probe_.series_over_max_total.value(), 0);
  ASSERT_THAT(lines_, SizeIs(1));
  EXPECT_THAT(lines_.front(), HasSubstr("over_robot_new_names_max=1"));
  SayJoints(robot, 65, 1000);
  EXPECT_THAT(NamesOf("rcan://a"), SizeIs(65 + kOfPresence)) << "a minute later";
}

TEST_F(RobotNamesTest, ARobotThatRenamesItsJointsAddsABoundedNumberOfNames) {
  robot::Robot& robot = Robot("rcan://a");
  Names all;
  std::size_t first = 0;
  const auto added_in_an_hour = [&] {
    const std::size_t before = all.size();
    for (const SteadyTime began = clock_.Steady(); clock_.Steady() - began < hours(1);) {
      SayJoints(robot, 100, first += 100);
      all.merge(NamesOf("rcan://a"));
    }
    return all.size() - before;
  };
  const std::size_t at_first = added_in_an_hour();
  EXPECT_GE(at_first, 512U);
  EXPECT_LE(at_first, kOfPresence + 512 + 64 + 64) << "free ones, a full bucket, an hour of it";
  EXPECT_LE(added_in_an_hour(), 64U);
  EXPECT_THAT(lines_, SizeIs(2)) << "once in each hour";
  EXPECT_EQ(probe_.robots_incomplete.value(), 1);
  EXPECT_GT(probe_.series_new_names_total.value(), 0);
}

TEST_F(RobotNamesTest, AnHonestRobotThatRestartsOrComesBackIsCompleteAtOnce) {
  robot::Robot& robot = Robot("rcan://a");
  SayJoints(robot, 300 - kOfPresence);
  const Names complete = NamesOf("rcan://a");
  EXPECT_THAT(complete, SizeIs(300));
  // Its program restarts, and says nothing of joints at first.
  SayJoints(robot, 0);
  EXPECT_THAT(NamesOf("rcan://a"), SizeIs(kOfPresence));
  SayJoints(robot, 300 - kOfPresence);
  EXPECT_EQ(NamesOf("rcan://a"), complete);
  // It is off for longer than its series stay.
  clock_.Advance(hours(8));
  robot.state.Sweep(clock_.Steady(), clock_.System(), {});
  EXPECT_THAT(NamesOf("rcan://a"), SizeIs(kOfPresence));
  SayJoints(robot, 300 - kOfPresence);
  EXPECT_EQ(NamesOf("rcan://a"), complete);
  // Its next version has more joints.
  SayJoints(robot, 400);
  EXPECT_THAT(NamesOf("rcan://a"), SizeIs(400 + kOfPresence));
  EXPECT_EQ(probe_.series_new_names_total.value(), 0);
  EXPECT_EQ(probe_.series_over_max_total.value(), 0);
  EXPECT_THAT(lines_, IsEmpty());
}

TEST_F(RobotNamesTest, ARobotThatRenamesTakesNothingFromAnother) {
  robot::Robot& renames = Robot("rcan://a");
  robot::Robot& honest = Robot("rcan://b");
  SayJoints(honest, 200);
  const Names complete = NamesOf("rcan://b");
  for (std::size_t i = 0; i < 120; ++i) {
    SayJoints(renames, 256, i * 256);
    SayJoints(honest, 200);
    EXPECT_EQ(NamesOf("rcan://b"), complete);
    EXPECT_LE(probe_.robots_incomplete.value(), 1);
  }
  SayJoints(honest, 240);
  EXPECT_THAT(NamesOf("rcan://b"), SizeIs(240 + kOfPresence)) << "and new ones have room";
  EXPECT_THAT(lines_, SizeIs(1));
}

TEST_F(RobotNamesTest, WhatIsKeptOfARobotStaysWhileOthersComeAndGoesWithIt) {
  SayJoints(Robot("rcan://b"), 513 - kOfPresence);
  const Names first = NamesOf("rcan://b");
  EXPECT_THAT(first, SizeIs(512));
  for (const char* other : {"rcan://a", "rcan://c"}) {
    SayJoints(Robot(other), 1);
    SayJoints(Robot("rcan://b"), 513 - kOfPresence, 100);
    EXPECT_LT(NamesOf("rcan://b").size(), 512U) << "its places are those of the names before";
  }
  robot::Robot& robot = Robot("rcan://b");
  ASSERT_TRUE(fleet_.BeginLeaving(robot, robot::Robot::LeaveWhen::kAtOnce));
  robot.OnLeft();
  ASSERT_THAT(fleet_.RemoveLeft(), SizeIs(1));
  EXPECT_THAT(NamesOf("rcan://b"), IsEmpty());
  SayJoints(Robot("rcan://b"), 512 - kOfPresence, 5000);
  EXPECT_THAT(NamesOf("rcan://b"), SizeIs(512)) << "it begins anew";
}

TEST_F(RobotNamesTest, SeriesThatAreNotWrittenTakeNoPlace) {
  config_.fields = {"robot_online"};
  RobotScrape scrape({clock_, fleet_, config_, faults_, probe_, logger_, {1, 2}});
  SayJoints(Robot("rcan://a"), 600);
  ASSERT_NE(scrape.Text(metrics::Format::kText, metrics::Coding::kPlain), nullptr);
  EXPECT_EQ(probe_.series.value(), 1);
  EXPECT_EQ(probe_.robots_incomplete.value(), 0);
}

TEST_F(RobotNamesTest, ARobotThatIsLeftOutWholeIsNotIncompleteBesides) {
  config_.series_max = 1;
  RobotScrape scrape({clock_, fleet_, config_, faults_, probe_, logger_, {1, 2}});
  SayJoints(Robot("rcan://a"), 600);
  ASSERT_NE(scrape.Text(metrics::Format::kText, metrics::Coding::kPlain), nullptr);
  EXPECT_EQ(probe_.robots_left_out.value(), 1);
  EXPECT_EQ(probe_.robots_incomplete.value(), 0);
  EXPECT_EQ(probe_.series_over_max_total.value(), 0);
  EXPECT_EQ(probe_.series_no_room_total.value(), 0);
}

TEST_F(RobotNamesTest, OfARobotWithoutRoomForItsNamesTheyAreLeftOutForThatAlone) {
  config_.series_max = 100;
  RobotScrape scrape({clock_, fleet_, config_, faults_, probe_, logger_, {1, 2}});
  SayJoints(Robot("rcan://a"), 600);
  ASSERT_NE(scrape.Text(metrics::Format::kText, metrics::Coding::kPlain), nullptr);
  EXPECT_EQ(probe_.series.value(), kOfPresence);
  EXPECT_EQ(probe_.robots_left_out.value(), 0);
  EXPECT_EQ(probe_.robots_incomplete.value(), 1);
  EXPECT_EQ(probe_.series_over_max_total.value(), 0);
  EXPECT_EQ(probe_.series_no_room_total.value(), 512 - kOfPresence);
  ASSERT_THAT(lines_, SizeIs(1));
  EXPECT_THAT(lines_.front(), HasSubstr("rcan_robots_left_out"));
}

TEST_F(RobotNamesTest, ManyIncompleteRobotsAreNamedTenAMinute) {
  for (int i = 0; i < 25; ++i) SayJoints(Robot("rcan://" + std::to_string(i)), 600);
  NamesOf("rcan://0");
  EXPECT_EQ(probe_.robots_incomplete.value(), 25);
  EXPECT_THAT(lines_, SizeIs(kRobotsNamedMax));
  for (int i = 0; i < 10; ++i) NamesOf("rcan://0");
  EXPECT_THAT(lines_, SizeIs(25)) << "each in its turn, and once";
}

TEST(NamedSeriesTest, AJointAndAComputerOfTheSameNameAreTwo) {
  using enum metrics::rcan::SeriesId;
  metrics::rcan::SeriesPage page({.series_max = 10});
  SeriesNames names;
  const NameRules rules{NameHash({}), {.names_max = 10, .new_per_hour = 1}};
  page.BeginRobot("r");
  NamedSeries series(page, names, rules, {.now = SteadyTime(hours(1))});
  const std::array<std::optional<double>, 1> one = {1.0};
  series.Add(kJointPositionRad, "x", one);
  series.Add(kCpuPct, "x", one);
  EXPECT_EQ(names.size(), 2U);
  EXPECT_EQ(page.robot_samples(), 2U);
}

}  // namespace
}  // namespace uplink::rcan
