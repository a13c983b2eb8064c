#include "server/fleet/forgetting.h"

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/journal/shards.h"
#include "tests/support/fake_store.h"
#include "tests/support/kept_lines.h"
#include "tests/support/manual_clock.h"
#include "tests/support/robot_streams.h"

namespace uplink::fleet {
namespace {

using std::chrono::hours;
using std::chrono::seconds;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr hours kForgetAfter{24};
constexpr std::size_t kRobotsMax = 3;

class ForgettingTest : public ::testing::Test {
 protected:
  ForgettingTest() {
    fleet_.OnPresence(
        [this](const storage::RobotRef& robot, const storage::StoredPresence& now, auto why) {
          journals_.NotePresence(robot, now.presence, now.since, why, now.parked_until);
        });
  }

  /// Null if it was refused.
  RobotPtr Come(const std::string& ruri) { return streams_.Come(ruri); }
  void Go(robot::Robot& robot) { streams_.Go(robot); }
  void ComeAndGo(const std::string& ruri) { Go(*Come(ruri)); }
  void Write() { streams_.Write(); }
  /// A second of the server.
  void Round(Forgetting& forgetting) {
    clock_.Advance(seconds(1));
    fleet_.Sweep(hours(1));
    forgetting.Round();
    if (!store_away_) Write();
  }
  void Rounds(int rounds) {
    for (int i = 0; i < rounds; ++i) Round(forgetting_);
  }
  std::vector<std::string> Known() {
    std::vector<std::string> ruris;
    for (const RobotPtr& robot : fleet_.Sorted()) ruris.push_back(robot->ruri());
    return ruris;
  }
  model::Presence LastRow(const std::string& ruri) {
    const auto changes = store_.PresenceChanges({});
    for (const auto& row : changes->rows) {
      if (row.robot.ruri == ruri) return row.presence;
    }
    return model::Presence::kUnknown;
  }

  testing::ManualClock clock_;
  testing::FakeDatabase database_;
  testing::FakeStore store_{database_, storage::ProcessId{1}};
  metrics::Ledger ledger_;
  journal::JournalProbe probe_;
  Fleet fleet_{clock_, kRobotsMax, {}};
  journal::Journal journal_{store_, {}, clock_, ledger_, probe_, storage::ProcessId{1}};
  journal::Shards journals_{{&journal_}};
  testing::RobotStreams streams_{fleet_, journal_, clock_};
  std::vector<std::string> lines_;
  log::Logger logger_{std::make_unique<testing::KeptLines>(lines_), clock_, log::Format::kText,
                      log::Level::kInfo};
  bool vouched_ = true;
  bool store_away_ = false;
  Forgetting forgetting_{{.fleet = fleet_,
                          .clock = clock_,
                          .logger = logger_,
                          .forget_after = kForgetAfter,
                          .clock_vouched = [this] { return vouched_; },
                          .release =
                              [this](robot::Robot& robot) {
                                journals_.Leave({.client = &robot, .robot = robot.id()});
                              }}};
};

TEST_F(ForgettingTest, ARobotThatIsSilentForTooLongLeavesAndIsThereAgainWhenItSpeaks) {
  ComeAndGo("a");
  const RobotPtr here = Come("b");
  clock_.Advance(kForgetAfter - seconds(20));
  Rounds(15);
  EXPECT_THAT(Known(), ElementsAre("a", "b"));
  Rounds(30);
  EXPECT_THAT(Known(), ElementsAre("b")) << "it has a stream";
  EXPECT_EQ(fleet_.forgotten(), 1U);
  EXPECT_EQ(fleet_.size(), 1U);
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("robots_forgotten robots=1 first=a")));
  EXPECT_EQ(LastRow("a"), model::Presence::kOffline);

  EXPECT_NE(Come("a"), nullptr);
  EXPECT_EQ(fleet_.Find("a")->state.presence(), model::Presence::kOnline);
  EXPECT_NE(fleet_.Find("a")->state.held_since(), 0U);
}

TEST_F(ForgettingTest, NobodyIsForgottenByAClockThatIsNotVouchedFor) {
  ComeAndGo("a");
  vouched_ = false;
  clock_.Advance(kForgetAfter * 100);
  Rounds(30);
  EXPECT_THAT(Known(), ElementsAre("a"));
  EXPECT_FALSE(forgetting_.IsForgotten(SystemTime()));
  vouched_ = true;
  Rounds(30);
  EXPECT_THAT(Known(), IsEmpty());
}

TEST_F(ForgettingTest, WithZeroNobodyIsForgotten) {
  Forgetting never({.fleet = fleet_,
                    .clock = clock_,
                    .logger = logger_,
                    .forget_after = milliseconds(0),
                    .clock_vouched = [] { return true; },
                    .release = [](robot::Robot&) { FAIL(); }});
  ComeAndGo("a");
  clock_.Advance(kForgetAfter * 1'000);
  for (int i = 0; i < 30; ++i) Round(never);
  EXPECT_THAT(Known(), ElementsAre("a"));
}

TEST_F(ForgettingTest, AtRobotsMaxTheLongestSilentLeavesForOneThatSpeaks) {
  const RobotPtr here = Come("a");
  for (const char* ruri : {"c", "b"}) {
    clock_.Advance(seconds(1));
    ComeAndGo(ruri);
  }
  Rounds(1);
  EXPECT_NE(Come("d"), nullptr);
  EXPECT_EQ(fleet_.size(), kRobotsMax);
  Rounds(20);
  EXPECT_THAT(Known(), ElementsAre("a", "b", "d"));
  EXPECT_EQ(LastRow("c"), model::Presence::kOffline) << "it was judged to the end";
}

TEST_F(ForgettingTest, WhoHasAStreamNeverLeaves) {
  const RobotPtr a = Come("a");
  const RobotPtr b = Come("b");
  const RobotPtr c = Come("c");
  Rounds(2);
  EXPECT_EQ(Come("d"), nullptr);
  EXPECT_THAT(Known(), ElementsAre("a", "b", "c"));
}

TEST_F(ForgettingTest, OneThatSpeaksWhileItLeavesStays) {
  const RobotPtr a = Come("a");
  const RobotPtr b = Come("b");
  ComeAndGo("c");
  Rounds(1);
  const RobotPtr d = Come("d");
  ASSERT_NE(d, nullptr);
  ASSERT_TRUE(fleet_.Find("c")->leaving());
  EXPECT_EQ(fleet_.leaving(), 1U);
  const RobotPtr back = Come("c");
  EXPECT_FALSE(back->leaving());
  EXPECT_EQ(fleet_.leaving(), 0U);
  Rounds(30);
  EXPECT_THAT(Known(), ElementsAre("a", "b", "c", "d"));
  EXPECT_EQ(Come("e"), nullptr) << "there are more than there may be already";
}

TEST_F(ForgettingTest, WhatWaitsForTheStoreKeepsARobot) {
  ComeAndGo("a");
  store_away_ = true;
  clock_.Advance(kForgetAfter);
  Rounds(30);
  EXPECT_THAT(Known(), ElementsAre("a")) << "that it is offline is not written";
  store_away_ = false;
  Rounds(3);
  EXPECT_THAT(Known(), IsEmpty());
  EXPECT_EQ(LastRow("a"), model::Presence::kOffline);
}

TEST_F(ForgettingTest, WhoLooksAtARobotKeepsIt) {
  ComeAndGo("a");
  RobotPtr kept = fleet_.Find("a");
  clock_.Advance(kForgetAfter);
  Rounds(30);
  EXPECT_THAT(Known(), ElementsAre("a"));
  kept.reset();
  Rounds(1);
  EXPECT_THAT(Known(), IsEmpty());
}

TEST_F(ForgettingTest, NoMoreThanSoManyLeaveAtOnce) {
  Fleet large(clock_, kLeavingMax + 2, {});
  for (std::size_t i = 0; i < kLeavingMax + 2; ++i) {
    ASSERT_TRUE(large.FindOrAdmit({std::to_string(i), "f"}).ok());
  }
  std::size_t leaving = 0;
  for (const RobotPtr& robot : large.All()) leaving += large.BeginLeaving(*robot) ? 1U : 0U;
  EXPECT_EQ(leaving, kLeavingMax);
  EXPECT_EQ(large.size(), 2U);
}

}  // namespace
}  // namespace uplink::fleet
