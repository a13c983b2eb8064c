// When an Ack goes out, and what it covers.
#include "tests/unit/server/session/session_test.h"

namespace uplink::session {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

class AckTest : public SessionTest {
 protected:
  AckTest() : stream_(server().Connect(SessionOf(1))) { static_cast<void>(stream_.TakeLines()); }
  BenchStream& stream_;
};

TEST_F(AckTest, LiveMessagesWaitForTheInterval) {
  stream_.Send(BatchFrame(Messages(1, 3, Motion())));
  server().Pass(limits_.session.ack_interval - milliseconds(1));
  EXPECT_THAT(stream_.TakeLines(), IsEmpty());
  server().Pass(milliseconds(1));
  EXPECT_THAT(stream_.TakeLines(), ElementsAre("ack 3 judged 3"));
  server().Pass(limits_.session.ack_interval * 3);
  EXPECT_THAT(stream_.TakeLines(), IsEmpty()) << "nothing new to say";
}

TEST_F(AckTest, TheIntervalBeginsWithTheFirstMessage) {
  stream_.Send(BatchFrame({{1, Motion()}}));
  server().Pass(milliseconds(600));
  stream_.Send(BatchFrame({{2, Motion()}}));
  server().Pass(milliseconds(400));
  EXPECT_THAT(stream_.TakeLines(), ElementsAre("ack 2 judged 2"));
}

TEST_F(AckTest, SixtyFourLiveMessagesAreAckedAtOnce) {
  stream_.Send(BatchFrame(Messages(1, 63, Motion())));
  EXPECT_THAT(stream_.TakeLines(), IsEmpty());
  stream_.Send(BatchFrame({{64, Motion()}}));
  EXPECT_THAT(stream_.TakeLines(), ElementsAre("ack 64 judged 64"));
  stream_.Send(BatchFrame(Messages(65, 127, Motion())));
  EXPECT_THAT(stream_.TakeLines(), IsEmpty()) << "the count begins again";
}

TEST_F(AckTest, ACommitIsAckedAtOnce) {
  stream_.Send(BatchFrame({{1, Fault()}, {2, Motion()}}));
  EXPECT_THAT(stream_.TakeLines(), IsEmpty());
  server().Commit();
  EXPECT_THAT(stream_.TakeLines(), ElementsAre("ack 2 judged 2"));
}

TEST_F(AckTest, OneCommitIsOneAck) {
  stream_.Send(BatchFrame(Messages(1, 20, Fault())));
  stream_.Send(BatchFrame(Messages(21, 40, Fault())));
  server().Commit();
  EXPECT_THAT(stream_.TakeLines(), ElementsAre("ack 40 judged 40"));
}

TEST_F(AckTest, ThroughStopsBelowTheFirstNumberThatWaits) {
  stream_.Send(BatchFrame({{1, Motion()}, {2, Motion()}, {3, Fault()}, {4, Motion()}}));
  server().Pass(limits_.session.ack_interval);
  EXPECT_THAT(stream_.TakeLines(), ElementsAre("ack 2 judged 4"));
}

TEST_F(AckTest, ThroughSkipsNumbersThatNeverCame) {
  stream_.Send(BatchFrame({{5, Motion()}, {9, Fault()}}));
  server().Pass(limits_.session.ack_interval);
  EXPECT_THAT(stream_.TakeLines(), ElementsAre("ack 5 judged 9"));
  server().Commit();
  EXPECT_THAT(stream_.TakeLines(), ElementsAre("ack 9 judged 9"));
}

TEST_F(AckTest, AStoreThatIsAwayHoldsThroughAlone) {
  server().StoreAway();
  stream_.Send(BatchFrame({{1, Fault()}, {2, Motion()}}));
  server().Commit();
  server().Pass(limits_.session.ack_interval);
  EXPECT_THAT(stream_.TakeLines(), ElementsAre("ack 0 judged 2"));
  stream_.Send(BatchFrame({{3, Fault()}}));
  server().Commit();
  server().Pass(limits_.session.ack_interval);
  EXPECT_THAT(stream_.TakeLines(), ElementsAre("ack 0 judged 3"));
  server().StoreBack();
  server().Commit();
  EXPECT_THAT(stream_.TakeLines(), ElementsAre("ack 2 judged 3", "ack 3 judged 3"))
      << "the batch that failed, then what came after it";
}

TEST_F(AckTest, BehindASlowReaderAcksBecomeOne) {
  stream_.StopReading();
  stream_.Send(BatchFrame({{1, Fault()}}));
  server().Commit();
  EXPECT_THAT(stream_.TakeLines(), ElementsAre("ack 1 judged 1")) << "under way";
  for (model::Seq seq = 2; seq <= 4; ++seq) {
    stream_.Send(BatchFrame({{seq, Fault()}}));
    server().Commit();
  }
  EXPECT_THAT(stream_.TakeLines(), IsEmpty());
  stream_.ReadAgain();
  EXPECT_THAT(stream_.TakeLines(), ElementsAre("ack 4 judged 4"));
}

TEST_F(AckTest, LatencyIsObservedOncePerDurableMessage) {
  stream_.Send(BatchFrame({{1, Fault()}, {2, Motion()}, {3, Fault()}}));
  server().Pass(milliseconds(40));
  server().Commit();
  EXPECT_NEAR(server().probe().ack_seconds.sum(), 0.08, 1e-6);
}

TEST_F(AckTest, CommittedMessagesLeaveTheRobotsFlight) {
  stream_.Send(BatchFrame(Messages(1, 5, Fault())));
  EXPECT_EQ(server().counts().in_flight, 5);
  EXPECT_EQ(server().robot().sessions.in_flight(), 5U);
  server().Commit();
  EXPECT_EQ(server().counts().in_flight, 0);
  EXPECT_EQ(server().counts().stored, 5U);
  EXPECT_EQ(server().robot().sessions.in_flight(), 0U);
}

}  // namespace
}  // namespace uplink::session
