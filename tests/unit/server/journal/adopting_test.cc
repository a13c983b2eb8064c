#include "server/journal/adopting.h"

#include <deque>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/server/journal/step_bench.h"

namespace uplink::journal {
namespace {

using ::testing::ElementsAre;
using testing::FailAt;
using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr storage::ProcessId kFormer{2};

class AdoptingTest : public ::testing::Test, protected StepBench {
 protected:
  /// A robot that another process holds, which is over.
  void Former(RecordingClient& client) {
    ASSERT_TRUE(former_.OpenStreams(std::vector{OpenOf(client, 1).request}).ok());
  }
  void Adopt(RecordingClient& client, storage::HolderEnd end = storage::HolderEnd::kEnded) {
    inbox.Adopt({.client = &client,
                 .request = {.robot = client.robot(), .holder = kFormer, .end = end},
                 .grace = {.ended = milliseconds(9), .silent = milliseconds(99)}});
  }

  testing::FakeStore former_{database, kFormer};
  CountingInbox wakes_;
  RecordingClient robot_{"rcan://a", {.inbox = &wakes_, .stream = 1}};
  Adopting adopting_{context(), holds};
};

TEST_F(AdoptingTest, HasNothingToDo) {
  EXPECT_EQ(adopting_.Advance(), std::nullopt);
  EXPECT_EQ(store.adopts(), 0U);
}

TEST_F(AdoptingTest, HoldsWhatItAdoptedAndSaysHow) {
  Former(robot_);
  Adopt(robot_);
  EXPECT_EQ(adopting_.Advance(), Step::kWorked);
  EXPECT_EQ(holds.robots().Since(robot_), 2U);
  const auto news = robot_.Holds();
  ASSERT_THAT(news, SizeIs(1));
  EXPECT_EQ(news[0].how, robot::HoldBegan::kAdopted);
  EXPECT_EQ(news[0].since, 2U);
  EXPECT_TRUE(news[0].was_known);
  EXPECT_EQ(news[0].grace, milliseconds(9));
  EXPECT_THAT(robot_.Told(), IsEmpty());
  EXPECT_EQ(probe.adopted.value(), 1);
  EXPECT_EQ(adopting_.Advance(), std::nullopt);
}

TEST_F(AdoptingTest, TheRobotOfASilentHolderHasTheLongerGrace) {
  Former(robot_);
  Adopt(robot_, storage::HolderEnd::kSilent);
  EXPECT_EQ(adopting_.Advance(), Step::kWorked);
  EXPECT_EQ(robot_.Holds()[0].grace, milliseconds(99));
}

TEST_F(AdoptingTest, LeavesARobotThatCameElsewhereMeanwhile) {
  Former(robot_);
  testing::FakeStore third(database, storage::ProcessId{3});
  ASSERT_TRUE(third.OpenStreams(std::vector{OpenOf(robot_, 1).request}).ok());
  Adopt(robot_);
  EXPECT_EQ(adopting_.Advance(), Step::kWorked);
  EXPECT_EQ(holds.robots().Since(robot_), 0U);
  EXPECT_THAT(robot_.Holds(), IsEmpty());
  EXPECT_EQ(probe.adopted.value(), 0);
}

TEST_F(AdoptingTest, ALostAnswerIsToldAgain) {
  Former(robot_);
  Adopt(robot_);
  store.FailNext(1, FailAt::kAfter);
  EXPECT_EQ(adopting_.Advance(), Step::kFailed);
  EXPECT_FALSE(errors.last().ok());
  EXPECT_EQ(adopting_.Advance(), Step::kWorked);
  EXPECT_EQ(holds.robots().Since(robot_), 2U);
  EXPECT_TRUE(errors.last().ok());
}

TEST_F(AdoptingTest, AfterFailuresFewerAreTriedAtOnce) {
  std::deque<RecordingClient> clients;
  for (int i = 0; i < 4; ++i) {
    Former(clients.emplace_back("rcan://" + std::to_string(i)));
    Adopt(clients.back());
  }
  store.FailNext(kFailuresToHalve, FailAt::kBefore);
  for (int i = 0; i < kFailuresToHalve; ++i) EXPECT_EQ(adopting_.Advance(), Step::kFailed);
  EXPECT_EQ(adopting_.Advance(), Step::kWorked);
  EXPECT_EQ(probe.adopted.value(), 2);
  EXPECT_EQ(adopting_.Advance(), Step::kWorked);
  EXPECT_EQ(probe.adopted.value(), 4);
}

TEST_F(AdoptingTest, AdoptsNoMoreInOneCallThanItsBound) {
  std::deque<RecordingClient> clients;
  for (std::size_t i = 0; i <= kAdoptsPerCallMax; ++i) {
    Former(clients.emplace_back("rcan://" + std::to_string(i)));
    Adopt(clients.back());
  }
  EXPECT_EQ(adopting_.Advance(), Step::kWorked);
  EXPECT_EQ(probe.adopted.value(), static_cast<std::int64_t>(kAdoptsPerCallMax));
  EXPECT_EQ(adopting_.Advance(), Step::kWorked);
  EXPECT_EQ(probe.adopted.value(), static_cast<std::int64_t>(kAdoptsPerCallMax) + 1);
}

TEST_F(AdoptingTest, ARobotWaitsOnceHoweverOftenItIsNamed) {
  Former(robot_);
  Adopt(robot_);
  Adopt(robot_);
  EXPECT_EQ(adopting_.Advance(), Step::kWorked);
  EXPECT_EQ(adopting_.Advance(), std::nullopt);
  EXPECT_EQ(store.adopts(), 1U);
  inbox.Lose({.client = &robot_, .robot = robot_.robot(), .since = 3});
  inbox.Lose({.client = &robot_, .robot = robot_.robot(), .since = 3});
  EXPECT_EQ(adopting_.Advance(), std::nullopt);
  EXPECT_THAT(robot_.Told(), ElementsAre("fenced"));
}

TEST_F(AdoptingTest, LetsGoOfWhatAnotherHoldsSince) {
  Hold(robot_);
  static_cast<void>(robot_.Holds());
  inbox.Lose({.client = &robot_, .robot = robot_.robot(), .since = 2});
  EXPECT_EQ(adopting_.Advance(), std::nullopt);
  EXPECT_THAT(robot_.Told(), ElementsAre("fenced"));
  EXPECT_EQ(wakes_.wakes(1), 1);
  EXPECT_EQ(holds.robots().Since(robot_), 0U);
}

TEST_F(AdoptingTest, KeepsWhatCameBackSinceThatWasSeen) {
  Hold(robot_);
  inbox.Lose({.client = &robot_, .robot = robot_.robot(), .since = 1});
  EXPECT_EQ(adopting_.Advance(), std::nullopt);
  EXPECT_THAT(robot_.Told(), IsEmpty());
  EXPECT_EQ(holds.robots().Since(robot_), 1U);
}

}  // namespace
}  // namespace uplink::journal
