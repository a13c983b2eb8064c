#include "server/journal/claiming.h"

#include <deque>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/server/journal/journal_bench.h"
#include "tests/unit/server/journal/step_bench.h"

namespace uplink::journal {
namespace {

using ::testing::ElementsAre;
using testing::FailAt;
using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr storage::ProcessId kElsewhere{2};

class ClaimingTest : public ::testing::Test, protected StepBench {
 protected:
  void Claim(RecordingClient& drone, RecordingClient& robot) {
    inbox.Claim({.client = &drone, .robot = &robot, .request = {.robot = robot.robot()}});
  }
  void ClaimNow() {
    Claim(*drone_, robot_);
    ASSERT_EQ(claiming_.Advance(), Step::kWorked);
  }
  /// Another process, which lives, has a stream of the robot.
  void HoldElsewhere() {
    ASSERT_TRUE(elsewhere_.OpenStreams(std::vector{OpenOf(robot_, 1).request}).ok());
    database.Renew(kElsewhere, {});
  }

  CountingInbox wakes_;
  testing::FakeStore elsewhere_{database, kElsewhere};
  RecordingClient robot_{"rcan://a", {.inbox = &wakes_, .stream = 1}};
  /// Shared, as drones are.
  std::shared_ptr<RecordingClient> drone_ =
      std::make_shared<RecordingClient>("rcan://a", loop::StreamRef{&wakes_, 2});
  Claiming claiming_{context(), holds};
};

TEST_F(ClaimingTest, HasNothingToClaim) { EXPECT_FALSE(claiming_.Advance().has_value()); }

TEST_F(ClaimingTest, TellsTheDroneAndWhoseItsRobotIsInOneCall) {
  robot_.EndStream();
  Claim(*drone_, robot_);
  EXPECT_FALSE(inbox.idle());
  EXPECT_EQ(claiming_.Advance(), Step::kWorked);
  EXPECT_TRUE(inbox.idle());
  EXPECT_THAT(drone_->Told(), ElementsAre("claimed"));
  EXPECT_EQ(wakes_.wakes(2), 1);
  const auto news = robot_.Holds();
  ASSERT_THAT(news, SizeIs(1));
  EXPECT_EQ(news[0].how, robot::HoldBegan::kOpened);
  EXPECT_FALSE(news[0].was_known) << "it is new to the store";
  EXPECT_EQ(holds.robots().Since(robot_), news[0].since);
  EXPECT_EQ(drone_->Claims().back().held_since, news[0].since);
  EXPECT_THAT(robot_.Told(), IsEmpty());
  EXPECT_FALSE(claiming_.Advance().has_value());
}

TEST_F(ClaimingTest, IsNoNewsToARobotThatIsHeldHere) {
  Hold(robot_);
  static_cast<void>(robot_.Holds());
  ClaimNow();
  EXPECT_THAT(drone_->Told(), ElementsAre("claimed"));
  EXPECT_THAT(robot_.Told(), IsEmpty());
  EXPECT_THAT(robot_.Holds(), IsEmpty());
}

TEST_F(ClaimingTest, LeavesARobotToTheProcessThatHasItsStream) {
  HoldElsewhere();
  ClaimNow();
  EXPECT_THAT(drone_->Told(), ElementsAre("claimed, held elsewhere"))
      << "what is durable commits all the same";
  EXPECT_NE(drone_->Claims().back().claim, 0U);
  EXPECT_THAT(robot_.Told(), ElementsAre("held elsewhere"))
      << "a stream that is here goes on: its OpenStream takes the robot";
  EXPECT_EQ(wakes_.wakes(1), 0);
  EXPECT_EQ(holds.robots().Since(robot_), 0U);
}

TEST_F(ClaimingTest, EndsAHoldThatAnotherProcessHasByNow) {
  Hold(robot_);
  HoldElsewhere();
  ClaimNow();
  EXPECT_THAT(drone_->Told(), ElementsAre("claimed, held elsewhere"));
  EXPECT_THAT(robot_.Told(), ElementsAre("fenced"));
  EXPECT_EQ(wakes_.wakes(1), 1);
  EXPECT_EQ(holds.robots().Since(robot_), 0U);
}

TEST_F(ClaimingTest, ARobotThatAnotherProcessHeldBetweenIsFenced) {
  Hold(robot_);
  HoldElsewhere();
  database.Release(kElsewhere);
  ClaimNow();
  EXPECT_THAT(drone_->Told(), ElementsAre("claimed"));
  EXPECT_THAT(robot_.Told(), ElementsAre("fenced")) << "its sessions may have gone on there";
  EXPECT_EQ(holds.robots().Since(robot_), drone_->Claims().back().held_since);
}

TEST_F(ClaimingTest, ADroneOfAnotherFleetIsToldThatAlone) {
  storage::OpenRequest south = OpenOf(robot_, 1).request;
  south.robot = std::make_shared<const model::RobotId>(model::RobotId{"rcan://a", "south"});
  ASSERT_TRUE(elsewhere_.OpenStreams(std::vector{south}).ok());
  robot_.EndStream();
  inbox.Claim({.client = drone_.get(),
               .robot = &robot_,
               .request = {.robot = robot_.robot(), .fleet_word = storage::FleetWord::kMatches}});
  EXPECT_EQ(claiming_.Advance(), Step::kWorked);
  EXPECT_THAT(drone_->Told(), ElementsAre("of fleet south"));
  EXPECT_THAT(robot_.Told(), IsEmpty());
  EXPECT_THAT(moves, IsEmpty());
  EXPECT_TRUE(inbox.idle());
  claiming_.DoubtAll();
  EXPECT_THAT(drone_->Told(), IsEmpty()) << "it has no claim";
}

TEST_F(ClaimingTest, TellsOfARobotThatMoves) {
  storage::OpenRequest south = OpenOf(robot_, 1).request;
  south.robot = std::make_shared<const model::RobotId>(model::RobotId{"rcan://a", "south"});
  ASSERT_TRUE(elsewhere_.OpenStreams(std::vector{south}).ok());
  ClaimNow();
  ASSERT_THAT(moves, SizeIs(1));
  EXPECT_EQ(moves[0].from, "south");
  EXPECT_EQ(moves[0].to, robot_.robot()->fleet);
}

TEST_F(ClaimingTest, AFailedCallIsTriedAgainWithWhatCameMeanwhile) {
  RecordingClient other("rcan://b");
  RecordingClient other_drone("rcan://b");
  for (const FailAt at : {FailAt::kBefore, FailAt::kAfter}) {
    Claim(*drone_, robot_);
    store.FailNext(1, at);
    EXPECT_EQ(claiming_.Advance(), Step::kFailed);
    EXPECT_FALSE(errors.last().ok());
    EXPECT_FALSE(inbox.idle());
    EXPECT_THAT(drone_->Told(), IsEmpty());
    Claim(*drone_, robot_);
    Claim(other_drone, other);
    EXPECT_EQ(claiming_.Advance(), Step::kWorked);
    EXPECT_THAT(drone_->Told(), ElementsAre("claimed")) << "once";
    EXPECT_THAT(other_drone.Told(), ElementsAre("claimed"));
    EXPECT_TRUE(errors.last().ok());
    EXPECT_TRUE(inbox.idle());
  }
}

TEST_F(ClaimingTest, AfterFailuresTheLaterHalfGoesBackAndComesNext) {
  std::deque<RecordingClient> robots;
  std::deque<RecordingClient> drones;
  for (int i = 0; i < 5; ++i) {
    const std::string ruri = "rcan://" + std::to_string(i);
    Claim(drones.emplace_back(ruri), robots.emplace_back(ruri));
  }
  store.FailNext(kFailuresToHalve, FailAt::kBefore);
  for (int i = 0; i < kFailuresToHalve; ++i) EXPECT_EQ(claiming_.Advance(), Step::kFailed);
  EXPECT_EQ(claiming_.Advance(), Step::kWorked);
  EXPECT_THAT(drones[1].Told(), ElementsAre("claimed"));
  EXPECT_THAT(drones[2].Told(), IsEmpty());
  EXPECT_EQ(claiming_.Advance(), Step::kWorked);
  EXPECT_THAT(drones[3].Told(), ElementsAre("claimed"));
  EXPECT_THAT(drones[4].Told(), IsEmpty()) << "a call is still half as large";
}

TEST_F(ClaimingTest, AllClaimsAreInDoubtAtOnceAndEachDroneIsToldOnce) {
  ClaimNow();
  ClaimNow();
  RecordingClient other("rcan://b");
  auto gone = std::make_shared<RecordingClient>("rcan://b");
  Claim(*gone, other);
  ASSERT_EQ(claiming_.Advance(), Step::kWorked);
  gone.reset();
  static_cast<void>(drone_->Told());
  const std::uint64_t before = drone_->generation();
  claiming_.DoubtAll();
  EXPECT_THAT(drone_->Told(), ElementsAre("doubted"));
  EXPECT_EQ(drone_->generation(), before) << "what waits stands";
  EXPECT_THAT(robot_.Told(), IsEmpty()) << "whose the robot is, the store is asked";
  claiming_.DoubtAll();
  EXPECT_THAT(drone_->Told(), IsEmpty());
}

/// Claims among all that a journal does.
class Claims : public ::testing::Test {
 protected:
  void Claim() {
    bench_.journal.Claim(*drone_, robot_, {.robot = robot_.robot(), .at = bench_.clock.System()});
  }
  void AppendSample(std::uint8_t digest, model::Seq seq) {
    const auto mark = std::make_shared<const storage::SampleMark>(
        storage::SampleMark{.claim = drone_->Claims().back().claim,
                            .type = 1,
                            .digest = {digest},
                            .timed = true,
                            .last = {}});
    std::vector<storage::CommitRecord> records;
    for (model::Seq of = seq; of < seq + 2; ++of) {
      records.push_back({.robot = robot_.robot(),
                         .session = JournalBench::kSession,
                         .seq = of,
                         .received_at = bench_.clock.System(),
                         .content = FaultRecord(),
                         .payload = {},
                         .sample = mark});
    }
    bench_.journal.AppendMessage(*drone_, drone_->generation(), std::move(records),
                                 bench_.clock.Steady());
  }

  JournalBench bench_;
  RecordingClient robot_{"rcan://a"};
  std::shared_ptr<RecordingClient> drone_ = std::make_shared<RecordingClient>("rcan://a");
};

TEST_F(Claims, ASampleIsStoredWithoutAStreamAndKnownAgain) {
  Claim();
  bench_.Run();
  AppendSample(1, 1);
  AppendSample(1, 3);
  bench_.Run();
  EXPECT_THAT(drone_->Told(), ElementsAre("claimed", "settled 1 2 3 again 4 again"));
  EXPECT_TRUE(bench_.journal.idle());
}

TEST_F(Claims, AnotherProcesssClaimEndsTheClaimAloneAndTheSampleCommitsUnderTheNext) {
  Claim();
  bench_.Run();
  testing::FakeStore elsewhere{bench_.database, kElsewhere};
  ASSERT_TRUE(
      elsewhere.ClaimDrones(std::vector<storage::ClaimRequest>{{.robot = robot_.robot()}}).ok());
  AppendSample(1, 1);
  AppendSample(2, 3);
  bench_.Run();
  EXPECT_THAT(drone_->Told(), ElementsAre("claimed", "fenced"));
  Claim();
  bench_.Run();
  AppendSample(1, 5);
  bench_.Run();
  EXPECT_THAT(drone_->Told(), ElementsAre("claimed", "settled 5 6"));
}

TEST_F(Claims, ALostAnswerStoresASampleOnceAndSaysThatItIsStored) {
  Claim();
  bench_.Run();
  AppendSample(1, 1);
  bench_.store.FailNextCommits(1, FailAt::kAfter);
  EXPECT_EQ(bench_.journal.turns().Advance(), Step::kFailed);
  bench_.Run();
  EXPECT_THAT(drone_->Told(), ElementsAre("claimed", "settled 1 2"));
}

TEST_F(Claims, AStoreThatWasConnectedToAnewIsInDoubtBeforeWhatWaitsIsCommitted) {
  Claim();
  bench_.Run();
  AppendSample(1, 1);
  bench_.store.Break();
  bench_.Run();
  EXPECT_THAT(drone_->Told(), ElementsAre("claimed", "doubted", "settled 1 2"));
  EXPECT_TRUE(bench_.journal.idle());
  Claim();
  bench_.Run();
  AppendSample(1, 3);
  bench_.Run();
  EXPECT_THAT(drone_->Told(), ElementsAre("claimed", "settled 3 again 4 again"));
}

TEST_F(Claims, AClaimWaitsForOneBatchOfRecordsAtMost) {
  RecordingClient busy("rcan://busy");
  bench_.Open(busy);
  bench_.Run();
  for (model::Seq seq = 1; seq <= 1'000; ++seq) bench_.Append(busy, seq);
  EXPECT_EQ(bench_.journal.turns().Advance(), Step::kWorked) << "a commit";
  Claim();
  for (int i = 0; i < 3 && drone_->Claims().empty(); ++i) {
    EXPECT_EQ(bench_.journal.turns().Advance(), Step::kWorked);
  }
  EXPECT_THAT(drone_->Told(), ElementsAre("claimed"));
  EXPECT_FALSE(bench_.journal.idle()) << "records wait still";
}

}  // namespace
}  // namespace uplink::journal
