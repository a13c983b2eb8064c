#include "server/journal/opening.h"

#include <deque>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/server/journal/step_bench.h"

namespace uplink::journal {
namespace {

using ::testing::ElementsAre;
using testing::FailAt;
using ::testing::IsEmpty;

class OpeningTest : public ::testing::Test, protected StepBench {
 protected:
  CountingInbox wakes_;
  RecordingClient robot_{"rcan://a", {.inbox = &wakes_, .stream = 1}};
  RecordingClient other_{"rcan://b"};
  Opening opening_{context(), holds};
};

TEST_F(OpeningTest, HasNothingToOpen) {
  EXPECT_FALSE(opening_.Gather().opens);
  EXPECT_EQ(store.opens(), 0U);
}

TEST_F(OpeningTest, HoldsTellsAndWakesInOneCall) {
  Open(robot_, 4);
  Open(other_, 5);
  EXPECT_TRUE(opening_.Gather().opens);
  EXPECT_THAT(robot_.Told(), IsEmpty());
  EXPECT_EQ(opening_.Open(), Step::kWorked);
  EXPECT_EQ(store.opens(), 1U);
  EXPECT_THAT(robot_.Told(), ElementsAre("opened 4"));
  EXPECT_THAT(other_.Told(), ElementsAre("opened 5"));
  EXPECT_EQ(wakes_.wakes(1), 1);
  EXPECT_EQ(holds.robots().Since(robot_), 1U);
  EXPECT_TRUE(inbox.idle());
  EXPECT_FALSE(opening_.Gather().opens);
}

TEST_F(OpeningTest, TellsOfARobotThatMovesAlsoOneThatItHeldNever) {
  testing::FakeStore another{database, storage::ProcessId{2}};
  ASSERT_TRUE(another.OpenStreams(std::vector{OpenOf(robot_, 1).request}).ok());
  const auto open = [&](const std::string& fleet, storage::FleetWord word, std::string gateway) {
    OpenEntry entry = OpenOf(robot_, 1);
    entry.request.robot = std::make_shared<const model::RobotId>(
        model::RobotId{.ruri = robot_.robot()->ruri, .fleet = fleet});
    entry.request.fleet_word = word;
    entry.gateway = std::move(gateway);
    inbox.Open(std::move(entry));
    static_cast<void>(opening_.Gather());
    EXPECT_EQ(opening_.Open(), Step::kWorked);
  };
  const std::string before = robot_.robot()->fleet;
  open("another", storage::FleetWord::kMatches, "CN=hall");
  EXPECT_THAT(moves, IsEmpty()) << "it is refused";
  open("another", storage::FleetWord::kMoves, "CN=hall");
  open("another", storage::FleetWord::kMoves, "CN=hall");
  ASSERT_EQ(moves.size(), 1U) << "once";
  EXPECT_EQ(moves[0].ruri, robot_.robot()->ruri);
  EXPECT_EQ(moves[0].from, before);
  EXPECT_EQ(moves[0].to, "another");
  EXPECT_EQ(moves[0].gateway, "CN=hall");
}

TEST_F(OpeningTest, SaysWhetherRecordsWait) {
  Open(robot_);
  EXPECT_FALSE(opening_.Gather().records_wait);
  Append(robot_, 1);
  EXPECT_TRUE(opening_.Gather().records_wait);
}

TEST_F(OpeningTest, ARobotThatIsNotJudgedYetHoldsUpNoOther) {
  robot_.SetRegistration(robot::Registration::kUnjudged);
  Open(robot_);
  Open(other_);
  static_cast<void>(opening_.Gather());
  EXPECT_EQ(opening_.Open(), Step::kWorked);
  EXPECT_THAT(other_.Told(), ElementsAre("opened 1"));
  EXPECT_TRUE(opening_.Gather().opens);
  EXPECT_EQ(opening_.Open(), Step::kFailed) << "it comes again after a pause";
  EXPECT_TRUE(errors.last().ok());
  EXPECT_THAT(robot_.Told(), IsEmpty());
  robot_.SetRegistration(robot::Registration::kFits);
  EXPECT_TRUE(opening_.Gather().opens);
  EXPECT_EQ(opening_.Open(), Step::kWorked);
  EXPECT_THAT(robot_.Told(), ElementsAre("opened 1"));
}

TEST_F(OpeningTest, ARefusedRobotIsToldAndGetsNoRow) {
  robot_.SetRegistration(robot::Registration::kRefused);
  Open(robot_);
  static_cast<void>(opening_.Gather());
  EXPECT_EQ(opening_.Open(), Step::kWorked);
  EXPECT_THAT(robot_.Told(), ElementsAre("not registered"));
  EXPECT_EQ(wakes_.wakes(1), 1);
  EXPECT_EQ(store.opens(), 0U);
  EXPECT_TRUE(inbox.idle());
}

TEST_F(OpeningTest, AFailedCallIsTriedAgainWithWhatCameMeanwhile) {
  Open(robot_, 1);
  store.FailNextOpens(1, FailAt::kBefore);
  static_cast<void>(opening_.Gather());
  EXPECT_EQ(opening_.Open(), Step::kFailed);
  EXPECT_FALSE(errors.last().ok());
  EXPECT_FALSE(inbox.idle());
  Open(robot_, 2);
  Open(other_, 3);
  static_cast<void>(opening_.Gather());
  EXPECT_EQ(opening_.Open(), Step::kWorked);
  EXPECT_THAT(robot_.Told(), ElementsAre("opened 2"));
  EXPECT_THAT(other_.Told(), ElementsAre("opened 3"));
  EXPECT_TRUE(errors.last().ok());
  EXPECT_TRUE(inbox.idle());
}

TEST_F(OpeningTest, ARobotThatAnotherProcessHeldBetweenIsFenced) {
  Hold(robot_);
  testing::FakeStore elsewhere(database, storage::ProcessId{2});
  ASSERT_TRUE(elsewhere.OpenStreams(std::vector{OpenOf(robot_, 1).request}).ok());
  Open(robot_, 2);
  static_cast<void>(opening_.Gather());
  EXPECT_EQ(opening_.Open(), Step::kWorked);
  EXPECT_THAT(robot_.Told(), ElementsAre("fenced"));
  EXPECT_EQ(holds.robots().Since(robot_), 3U) << "it is ours again since this stream";
}

TEST_F(OpeningTest, SaysOfWhichHoldAndPresence) {
  Open(robot_);
  static_cast<void>(opening_.Gather());
  EXPECT_EQ(opening_.Open(), Step::kWorked);
  auto news = robot_.Holds();
  ASSERT_EQ(news.size(), 1U);
  EXPECT_EQ(news[0].how, robot::HoldBegan::kOpened);
  EXPECT_EQ(news[0].since, 1U);
  EXPECT_FALSE(news[0].was_known) << "it is new to the store";
  Open(robot_, 2);
  static_cast<void>(opening_.Gather());
  EXPECT_EQ(opening_.Open(), Step::kWorked);
  EXPECT_THAT(robot_.Holds(), IsEmpty()) << "another stream of the same hold";
}

TEST_F(OpeningTest, AnEndedStreamTakesNothingFromWhoHasALease) {
  constexpr storage::ProcessId kElsewhere{2};
  testing::FakeStore elsewhere(database, kElsewhere);
  ASSERT_TRUE(elsewhere.OpenStreams(std::vector{OpenOf(robot_, 1).request}).ok());
  database.Renew(kElsewhere, {});
  Open(robot_, 2);
  robot_.EndStream();
  static_cast<void>(opening_.Gather());
  EXPECT_EQ(opening_.Open(), Step::kWorked);
  EXPECT_THAT(robot_.Told(), ElementsAre("fenced")) << "its records are superseded";
  EXPECT_EQ(holds.robots().Since(robot_), 0U);
  EXPECT_TRUE(inbox.idle());
}

TEST_F(OpeningTest, AStreamThatCameMeanwhileIsNotFencedByTheAnswerOfAnEndedOne) {
  constexpr storage::ProcessId kElsewhere{2};
  testing::FakeStore elsewhere(database, kElsewhere);
  ASSERT_TRUE(elsewhere.OpenStreams(std::vector{OpenOf(robot_, 1).request}).ok());
  database.Renew(kElsewhere, {});
  Open(robot_, 2);
  robot_.EndStreamForOneLook();
  static_cast<void>(opening_.Gather());
  EXPECT_EQ(opening_.Open(), Step::kWorked);
  EXPECT_THAT(robot_.Told(), IsEmpty());
  EXPECT_FALSE(inbox.idle());
  EXPECT_TRUE(opening_.Gather().opens) << "it is asked for again: records may wait for it";
  EXPECT_EQ(opening_.Open(), Step::kWorked);
  EXPECT_THAT(robot_.Told(), ElementsAre("opened 2"));
  EXPECT_TRUE(inbox.idle());
}

TEST_F(OpeningTest, AStreamOfAnotherFleetIsToldThatAndHoldsNothing) {
  testing::FakeStore elsewhere(database, storage::ProcessId{2});
  OpenEntry open = OpenOf(robot_, 2);
  open.request.robot = std::make_shared<const model::RobotId>(model::RobotId{"rcan://a", "south"});
  ASSERT_TRUE(elsewhere.OpenStreams(std::vector{open.request}).ok());
  open.request.robot = robot_.robot();
  open.request.fleet_word = storage::FleetWord::kMatches;
  inbox.Open(std::move(open));
  Append(robot_, 1);
  Open(other_);
  static_cast<void>(opening_.Gather());
  EXPECT_EQ(opening_.Open(), Step::kWorked);
  EXPECT_THAT(robot_.Told(), ElementsAre("refused 2: of south"));
  EXPECT_EQ(wakes_.wakes(1), 1);
  EXPECT_EQ(holds.robots().Since(robot_), 0U);
  EXPECT_THAT(other_.Told(), ElementsAre("opened 1"));
  EXPECT_FALSE(opening_.Gather().opens) << "though its stream is here, it is not asked again";
}

TEST_F(OpeningTest, AfterFailuresTheLaterHalfGoesBackAndComesNext) {
  std::deque<RecordingClient> clients;
  for (int i = 0; i < 5; ++i) Open(clients.emplace_back("rcan://" + std::to_string(i)));
  static_cast<void>(opening_.Gather());
  store.FailNextOpens(kFailuresToHalve, FailAt::kBefore);
  for (int i = 0; i < kFailuresToHalve; ++i) EXPECT_EQ(opening_.Open(), Step::kFailed);
  EXPECT_EQ(opening_.Open(), Step::kWorked);
  EXPECT_THAT(clients[1].Told(), ElementsAre("opened 1"));
  EXPECT_THAT(clients[2].Told(), IsEmpty());
  EXPECT_TRUE(opening_.Gather().opens);
  EXPECT_EQ(opening_.Open(), Step::kWorked);
  EXPECT_THAT(clients[3].Told(), ElementsAre("opened 1"));
  EXPECT_THAT(clients[4].Told(), IsEmpty()) << "a call is still half as large";
}

TEST_F(OpeningTest, ASingleStreamIsNotHalved) {
  Open(robot_);
  static_cast<void>(opening_.Gather());
  store.FailNextOpens(kFailuresToHalve + 1, FailAt::kBefore);
  for (int i = 0; i <= kFailuresToHalve; ++i) EXPECT_EQ(opening_.Open(), Step::kFailed);
  Open(other_);
  static_cast<void>(opening_.Gather());
  EXPECT_EQ(opening_.Open(), Step::kWorked);
  EXPECT_THAT(other_.Told(), ElementsAre("opened 1")) << "in the same call";
}

}  // namespace
}  // namespace uplink::journal
