// What a stream forwards, and when: behind what is its own, and never instead of it.
#include <string>
#include <vector>

#include "tests/unit/server/session/scripted_forwards.h"
#include "tests/unit/server/session/session_test.h"

namespace uplink::session {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

/// A base, so that it outlives the streams of the test.
class WithForwards {
 protected:
  ScriptedForwards forwards_;
};

class ForwardTest : public WithForwards, public SessionTest {
 protected:
  ForwardTest() { server().forwards = &forwards_; }

  BenchStream& ConnectWith(const v1::RelayRequest& hello) {
    BenchStream& stream = server().Open();
    stream.Send(hello);
    server().Commit();
    return stream;
  }
};

TEST_F(ForwardTest, AStreamReceivesFromItsWelcomeOn) {
  BenchStream& stream = server().Open();
  stream.Send(HelloFrame(SessionOf(1)));
  EXPECT_THAT(forwards_.joined, IsEmpty()) << "it was not welcomed yet";
  server().Commit();
  EXPECT_THAT(forwards_.joined, ElementsAre("bench rcan://bench/1"));
  forwards_.Offer("rcan://a/1");
  server().DeliverWakes();
  EXPECT_THAT(stream.TakeLines(),
              ElementsAre("welcome 0", "ack 0 judged 0", "forward 2 rcan://a/1"));
}

TEST_F(ForwardTest, WhoDeclinesReceivesNothing) {
  v1::RelayRequest hello = HelloFrame(SessionOf(1));
  hello.mutable_hello()->set_declines_forwards(true);
  ConnectWith(hello);
  EXPECT_THAT(forwards_.joined, IsEmpty());
}

TEST_F(ForwardTest, AcksAndRejectsGoFirst) {
  BenchStream& stream = server().Connect(SessionOf(1));
  static_cast<void>(stream.TakeLines());
  stream.StopReading();
  forwards_.at_once = 1;
  forwards_.Offer("rcan://a/1");
  forwards_.Offer("rcan://a/2");
  server().DeliverWakes();
  stream.SendOnce(BatchFrame({{1, BadFault()}, {2, Fault()}}));
  server().Commit();
  stream.ReadAgain();
  server().DeliverWakes();
  EXPECT_THAT(stream.TakeLines(),
              ElementsAre("forward 2 rcan://a/1", "reject 1 missing_field faultId",
                          "ack 2 judged 2", "forward 2 rcan://a/2"));
}

TEST_F(ForwardTest, APeerThatDoesNotReadIsNotHeldBackForForwards) {
  BenchStream& stream = server().Connect(SessionOf(1));
  stream.StopReading();
  for (std::size_t i = 0; i < 2 * kOutgoingFramesMax; ++i) forwards_.Offer("rcan://a/1");
  server().DeliverWakes();
  stream.SendOnce(BatchFrame({{1, Motion()}}));
  EXPECT_TRUE(stream.reading()) << "its messages are read";
  server().Pass(kPeerStallMax + milliseconds(1));
  EXPECT_EQ(stream.end(), "");
}

TEST_F(ForwardTest, ALongSnapshotGivesItsThreadToOthersInBetween) {
  BenchStream& stream = server().Connect(SessionOf(1));
  static_cast<void>(stream.TakeLines());
  forwards_.at_once = 1;
  for (std::size_t i = 0; i < 3 * kForwardsPerTurn; ++i) forwards_.Offer("rcan://a/1");
  ASSERT_TRUE(server().TakeWake(1));
  stream.Wake();
  EXPECT_THAT(stream.TakeLines(), SizeIs(kForwardsPerTurn));
  EXPECT_TRUE(server().TakeWake(1)) << "it asks for its next turn";
  stream.Wake();
  EXPECT_THAT(stream.TakeLines(), SizeIs(kForwardsPerTurn));
}

TEST_F(ForwardTest, AStreamThatEndsReceivesNoMore) {
  BenchStream& half_closed = server().Connect(SessionOf(1));
  half_closed.HalfClose();
  EXPECT_EQ(forwards_.receiving, 0);
  EXPECT_EQ(half_closed.end(), "OK");
  BenchStream& broken = server().Connect(SessionOf(1));
  EXPECT_EQ(forwards_.receiving, 1);
  broken.Break();
  EXPECT_EQ(forwards_.receiving, 0);
  BenchStream& drained = server().Connect(SessionOf(1));
  drained.StopReading();
  forwards_.Offer("rcan://a/1");
  drained.Drain(milliseconds(1000));
  EXPECT_EQ(forwards_.receiving, 0);
  EXPECT_THAT(forwards_.offered, SizeIs(1)) << "what was not taken stays where it is";
}

TEST_F(ForwardTest, OfTwoStreamsOfARobotTheNewerReceives) {
  server().Connect(SessionOf(1));
  server().Connect(SessionOf(2));
  server().DeliverWakes();
  server().Commit();
  EXPECT_EQ(forwards_.receiving, 1);
}

}  // namespace
}  // namespace uplink::session
