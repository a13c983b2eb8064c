#include "server/journal/checkpoint_rounds.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/server/journal/listed_rows.h"
#include "tests/unit/server/journal/step_bench.h"

namespace uplink::journal {
namespace {

using ::testing::ElementsAre;
using testing::FailAt;
using ::testing::SizeIs;

constexpr std::chrono::seconds kEvery{5};

class CheckpointRoundsTest : public ::testing::Test, protected StepBench {
 protected:
  CheckpointRoundsTest() {
    rounds_.SetSource(live_, kEvery);
    Hold(robot_);
  }

  RecordingClient robot_{"rcan://a"};
  ListedRows live_;
  CheckpointRounds rounds_{context(), holds};
};

TEST_F(CheckpointRoundsTest, WithoutASourceNoneIsDue) {
  CheckpointRounds rounds(context(), holds);
  EXPECT_EQ(rounds.duty().due(), Duty::kNever);
  clock.Advance(std::chrono::hours(9));
  EXPECT_EQ(rounds.Advance(), std::nullopt);
  EXPECT_NE(rounds_.duty().due(), Duty::kNever);
}

TEST_F(CheckpointRoundsTest, BeginsWhenItIsDueAndEndsWithTheLastRow) {
  live_.Add("rcan://a");
  clock.Advance(kEvery - milliseconds(1));
  EXPECT_EQ(rounds_.Advance(), std::nullopt);
  clock.Advance(milliseconds(1));
  EXPECT_EQ(rounds_.Advance(), Step::kWorked);
  EXPECT_THAT(store.LiveOf(std::vector<std::string>{"rcan://a"})->rows, SizeIs(1));
  EXPECT_EQ(rounds_.Advance(), Step::kWorked) << "it asks whether more is left";
  EXPECT_EQ(rounds_.Advance(), std::nullopt);
  EXPECT_EQ(rounds_.duty().due(), clock.Steady() + kEvery);
  EXPECT_EQ(live_.rounds, 1);
  EXPECT_EQ(probe.checkpoint_robots.value(), 1);
}

TEST_F(CheckpointRoundsTest, BeginsAtOnceWhenItIsAskedFor) {
  inbox.RequestCheckpoint();
  EXPECT_EQ(rounds_.Advance(), Step::kWorked);
  EXPECT_EQ(live_.rounds, 1);
  EXPECT_TRUE(inbox.idle());
}

TEST_F(CheckpointRoundsTest, TellsItsSourceWhichRowsWerePassedOver) {
  live_.Add("rcan://not ours");
  inbox.RequestCheckpoint();
  EXPECT_EQ(rounds_.Advance(), Step::kWorked);
  EXPECT_THAT(live_.passed_over, ElementsAre("rcan://not ours"));
  EXPECT_EQ(probe.checkpoint_robots.value(), 0);
}

TEST_F(CheckpointRoundsTest, ARobotThatTheStorePassesOverIsHeldNoMore) {
  // Another process holds it, and nothing of it is committed that would say so.
  const storage::OpenRequest request{.robot = robot_.robot()};
  testing::FakeStore another(database, storage::ProcessId{2});
  ASSERT_TRUE(another.OpenStreams({&request, 1}).ok());
  live_.Add("rcan://a");
  inbox.RequestCheckpoint();
  EXPECT_EQ(rounds_.Advance(), Step::kWorked);
  EXPECT_THAT(live_.passed_over, ElementsAre("rcan://a"));
  EXPECT_EQ(holds.robots().Since(robot_), 0U);
  EXPECT_THAT(robot_.Told(), ElementsAre("fenced"));
}

TEST_F(CheckpointRoundsTest, ARowOfAnEarlierHoldLosesNoLaterOne) {
  live_.rows.push_back({.ruri = "rcan://a", .held_since = holds.robots().Since(robot_) + 1});
  inbox.RequestCheckpoint();
  EXPECT_EQ(rounds_.Advance(), Step::kWorked);
  EXPECT_THAT(live_.passed_over, ElementsAre("rcan://a"));
  EXPECT_NE(holds.robots().Since(robot_), 0U);
}

TEST_F(CheckpointRoundsTest, WhileTheStoreIsAwayTheRoundEndsAndItsRowsGoBack) {
  live_.Add("rcan://a");
  live_.Add("rcan://a");
  clock.Advance(kEvery);
  store.FailNextCheckpoints(1, FailAt::kBefore);
  EXPECT_EQ(rounds_.Advance(), Step::kFailed);
  EXPECT_EQ(live_.put_back, 1U);
  EXPECT_TRUE(absl::IsUnavailable(errors.last()));
  EXPECT_TRUE(checkpoint_error.last().ok());
  EXPECT_EQ(rounds_.duty().due(), clock.Steady() + kEvery);
  EXPECT_EQ(rounds_.Advance(), std::nullopt);
}

TEST_F(CheckpointRoundsTest, OneThatWasAskedForIsBegunAgainWhenTheStoreWasAway) {
  live_.Add("rcan://a");
  inbox.RequestCheckpoint();
  store.FailNextCheckpoints(1, FailAt::kBefore);
  EXPECT_EQ(rounds_.Advance(), Step::kFailed);
  EXPECT_FALSE(inbox.idle());
  EXPECT_EQ(rounds_.Advance(), Step::kWorked);
  EXPECT_EQ(rounds_.Advance(), Step::kWorked);
  EXPECT_EQ(live_.rounds, 2);
  EXPECT_TRUE(inbox.idle());
}

TEST_F(CheckpointRoundsTest, AnErrorOfItsOwnLetsTheRoundGoOn) {
  live_.Add("rcan://a");
  live_.Add("rcan://a");
  clock.Advance(kEvery);
  store.FailNextCheckpoints(1, FailAt::kBefore, absl::InternalError("refused"));
  EXPECT_EQ(rounds_.Advance(), Step::kWorked);
  EXPECT_EQ(live_.put_back, 1U);
  EXPECT_TRUE(errors.last().ok());
  EXPECT_TRUE(absl::IsInternal(checkpoint_error.last()));
  EXPECT_EQ(probe.checkpoint_failing.value(), 1);
  EXPECT_EQ(rounds_.Advance(), Step::kWorked);
  EXPECT_EQ(live_.rounds, 1);
  EXPECT_TRUE(checkpoint_error.last().ok());
  EXPECT_EQ(probe.checkpoint_failing.value(), 0);
}

TEST_F(CheckpointRoundsTest, EachFailureHalvesACallAndEachSuccessDoublesIt) {
  for (int i = 0; i < 5; ++i) live_.Add("rcan://a");
  clock.Advance(kEvery);
  store.FailNextCheckpoints(2, FailAt::kBefore, absl::InternalError("refused"));
  for (int i = 0; i < 5; ++i) EXPECT_EQ(rounds_.Advance(), Step::kWorked);
  constexpr std::size_t kMost = storage::kCheckpointRowsMax;
  EXPECT_THAT(live_.rows_max_asked, ElementsAre(kMost, kMost / 2, kMost / 4, kMost / 2, kMost));
}

}  // namespace
}  // namespace uplink::journal
