// Which clients of a twin are its connections, and when these end.
#include "server/broker/twin_connections.h"

#include <memory>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/kept_connections.h"
#include "tests/support/manual_clock.h"

namespace uplink::broker {
namespace {

using model::cyberwave::Mark;
using model::cyberwave::MarkKind;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

class TwinConnectionsTest : public ::testing::Test {
 protected:
  [[nodiscard]] cyberwave::Arrival Now() const { return {clock_.Steady(), clock_.System()}; }
  void Live(const std::string& session) {
    connections_.Hear(kept_.reports(), robot_,
                      {.session = session, .live = true, .bytes = 100, .arrived = Now()});
  }
  void Say(const std::string& session, MarkKind kind) {
    const Mark mark{.kind = kind};
    connections_.Hear(kept_.reports(), robot_,
                      {.session = session, .mark = &mark, .bytes = 10, .arrived = Now()});
  }
  void LookForSilence() {
    connections_.EndSilent(kept_.reports(), robot_, clock_.Steady(), heard_all_since_);
  }

  testing::ManualClock clock_;
  testing::KeptConnections kept_{clock_};
  const robot::PresenceChanged untold_;
  robot::Robot robot_{std::make_shared<const model::RobotId>(model::RobotId{
                          .ruri = "rcan://local.rcan/cyberwave/twin/1", .fleet = "arms"}),
                      clock_.Steady(), clock_, untold_};
  TwinConnections connections_;
  SteadyTime heard_all_since_;
};

TEST_F(TwinConnectionsTest, BeginsWithTheFirstLiveMessage) {
  Live("a");
  Live("a");
  ASSERT_THAT(kept_.begun(), SizeIs(1));
  EXPECT_EQ(kept_.begun()[0].address, "a");
  EXPECT_EQ(kept_.begun()[0].source, model::MessageSource::kCyberwave);
  Say("a", MarkKind::kDisconnected);
  ASSERT_THAT(kept_.ended(), SizeIs(1));
  EXPECT_EQ(kept_.ended()[0].messages, 2U);
  EXPECT_EQ(kept_.ended()[0].bytes, 200U);
}

TEST_F(TwinConnectionsTest, BeganWhenItsClientConnected) {
  const SystemTime connected = clock_.System();
  Say("a", MarkKind::kConnected);
  clock_.Advance(milliseconds(700));
  Live("a");
  ASSERT_THAT(kept_.begun(), SizeIs(1));
  EXPECT_EQ(kept_.begun()[0].began_at, connected);
}

TEST_F(TwinConnectionsTest, IsKeptAgainWithWhatItBroughtNowAndThen) {
  Live("a");
  Live("a");
  EXPECT_THAT(kept_.updated(), IsEmpty());
  clock_.Advance(robot::kConnectionUpdateEvery);
  Live("a");
  Live("a");
  ASSERT_THAT(kept_.updated(), SizeIs(1));
  EXPECT_EQ(kept_.updated()[0].messages, 3U);
  EXPECT_EQ(kept_.updated()[0].id, kept_.begun()[0].id);
}

TEST_F(TwinConnectionsTest, AViewerIsNone) {
  Live("a");
  Say("viewer", MarkKind::kConnected);
  Say("viewer", MarkKind::kDisconnected);
  EXPECT_THAT(kept_.begun(), SizeIs(1));
  EXPECT_THAT(kept_.ended(), IsEmpty()) << "a viewer that leaves ends nothing";
}

TEST_F(TwinConnectionsTest, TheClientThatSentLiveMessagesLastParksTheRobot) {
  Live("a");
  Live("b");
  Say("a", MarkKind::kDisconnected);
  EXPECT_EQ(robot_.state.parked_until(), std::nullopt) << "the driver is another client by now";
  Say("viewer", MarkKind::kDisconnected);
  EXPECT_EQ(robot_.state.parked_until(), std::nullopt);
  Say("b", MarkKind::kDisconnected);
  EXPECT_EQ(robot_.state.parked_until(), clock_.System() + config::PresenceConfig().parked_max);
}

TEST_F(TwinConnectionsTest, ALiveMessageThatWasOnItsWayDoesNotEndTheParking) {
  const robot::PresenceLimits limits;
  Live("a");
  Say("a", MarkKind::kDisconnected);
  clock_.Advance(kTwinReturnsAfter - milliseconds(1));
  robot_.state.SignOfLife(clock_.Steady(), clock_.System(), limits);
  EXPECT_TRUE(robot_.state.parked_until().has_value());
  clock_.Advance(milliseconds(1));
  robot_.state.SignOfLife(clock_.Steady(), clock_.System(), limits);
  EXPECT_EQ(robot_.state.parked_until(), std::nullopt);
}

TEST_F(TwinConnectionsTest, OfTwoClientsEachEndsByItself) {
  Live("a");
  Live("b");
  Say("a", MarkKind::kDisconnected);
  EXPECT_THAT(kept_.Ends(), ElementsAre("orderly"));
  EXPECT_EQ(robot_.state.last_end(), std::nullopt) << "the twin is still there";
  Say("b", MarkKind::kDisconnected);
  EXPECT_EQ(robot_.state.last_end(), model::ConnectionEnd::kOrderly);
}

TEST_F(TwinConnectionsTest, ALiveMessageThatWasOnItsWayDoesNotBeginAnother) {
  Live("a");
  Say("a", MarkKind::kDisconnected);
  Live("a");
  EXPECT_THAT(kept_.begun(), SizeIs(1));
  clock_.Advance(kTwinReturnsAfter);
  Live("a");
  EXPECT_THAT(kept_.begun(), SizeIs(2));
}

TEST_F(TwinConnectionsTest, AClientThatConnectsAgainBeginsAnotherAtOnce) {
  Live("a");
  Say("a", MarkKind::kDisconnected);
  Say("a", MarkKind::kConnected);
  Live("a");
  EXPECT_THAT(kept_.begun(), SizeIs(2));
}

TEST_F(TwinConnectionsTest, SilenceEndsItWhenItWasLastHeard) {
  const SystemTime heard = clock_.System();
  Live("a");
  clock_.Advance(kTwinSilentMax - milliseconds(1));
  LookForSilence();
  EXPECT_THAT(kept_.ended(), IsEmpty());
  clock_.Advance(milliseconds(1));
  LookForSilence();
  ASSERT_THAT(kept_.Ends(), ElementsAre("silent"));
  EXPECT_EQ(kept_.ended()[0].ended->at, heard);
}

TEST_F(TwinConnectionsTest, SilenceOfTheBrokerEndsNone) {
  Live("a");
  clock_.Advance(2 * kTwinSilentMax);
  heard_all_since_ = clock_.Steady();
  LookForSilence();
  EXPECT_THAT(kept_.ended(), IsEmpty());
  clock_.Advance(kTwinSilentMax);
  LookForSilence();
  EXPECT_THAT(kept_.Ends(), ElementsAre("silent"));
}

TEST_F(TwinConnectionsTest, OneTooManyTakesThePlaceOfTheOneHeardLeastRecently) {
  for (std::size_t i = 0; i < kTwinConnectionsMax; ++i) Live("client " + std::to_string(i));
  Live("client 0");
  EXPECT_THAT(kept_.ended(), IsEmpty());
  Live("another");
  ASSERT_THAT(kept_.Ends(), ElementsAre("replaced"));
  EXPECT_EQ(kept_.ended()[0].address, "client 1");
}

TEST_F(TwinConnectionsTest, AServerThatHearsTheTwinNoMoreEndsAll) {
  Live("a");
  Live("b");
  connections_.EndAll(kept_.reports(), robot_, clock_.System(), transport::EndCause::kDrain);
  EXPECT_THAT(kept_.Ends(), ElementsAre("drained", "drained"));
}

}  // namespace
}  // namespace uplink::broker
