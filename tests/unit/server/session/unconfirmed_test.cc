// A stream whose agent does not confirm its Rejects: when it ends, and how the next one goes on.
#include <algorithm>

#include "tests/unit/server/session/session_test.h"

namespace uplink::session {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

std::string BadReject(model::Seq seq) {
  return "reject " + std::to_string(seq) + " missing_field faultId";
}

class UnconfirmedTest : public SessionTest {
 protected:
  UnconfirmedTest() { limits_.session.unconfirmed_rejects_max = 5; }

  BenchStream& Welcomed() {
    BenchStream& stream = server().Connect(SessionOf(1));
    static_cast<void>(stream.TakeLines());
    return stream;
  }
  /// A stream that ended at the bound, with all of it committed and acked.
  void FillTheBound() {
    BenchStream& stream = Welcomed();
    stream.Send(BatchFrame(Messages(1, 5, BadFault())));
    server().Commit();
    EXPECT_EQ(stream.TakeLines().back(), "ack 5 judged 5");
    EXPECT_EQ(stream.end(), EndAt(5));
  }
  [[nodiscard]] std::string EndAt(std::size_t rejects) const {
    return "UNAVAILABLE: " + std::to_string(rejects) +
           " Rejects of this session are above Hello.settled_seq, the limit is " +
           std::to_string(limits_.session.unconfirmed_rejects_max) +
           ": process them, and reconnect with the through_seq of the last Ack";
  }
};

TEST_F(UnconfirmedTest, BelowTheBoundTheStreamGoesOn) {
  BenchStream& stream = Welcomed();
  stream.Send(BatchFrame(Messages(1, 4, BadFault())));
  server().Commit();
  EXPECT_TRUE(stream.reading());
  EXPECT_EQ(stream.end(), "");
  EXPECT_EQ(server().probe().unconfirmed_total.value(), 0);
}

TEST_F(UnconfirmedTest, AtTheBoundWhatWasJudgedIsSettledAndAckedAndTheStreamEnds) {
  BenchStream& stream = Welcomed();
  stream.Send(BatchFrame({{1, Fault()}, {2, Motion()}}));
  std::vector<Message> messages = Messages(3, 7, BadFault());
  messages.push_back({8, Fault()});
  messages.push_back({9, Motion()});
  stream.Send(BatchFrame(messages));
  EXPECT_THAT(stream.TakeLines(),
              ElementsAre(BadReject(3), BadReject(4), BadReject(5), BadReject(6), BadReject(7)));
  EXPECT_EQ(stream.end(), "");
  EXPECT_FALSE(stream.reading());
  EXPECT_TRUE(server().robot().state.held_back()) << "it is we who do not listen";
  server().Commit();
  EXPECT_EQ(stream.TakeLines().back(), "ack 7 judged 7");
  EXPECT_EQ(stream.end(), EndAt(5));
  EXPECT_FALSE(server().robot().state.held_back());
  EXPECT_EQ(server().counts().received, 7U) << "what was not judged was not taken";
  EXPECT_THAT(Stored(1), ElementsAre(1));
  EXPECT_EQ(server().probe().unconfirmed_total.value(), 1);
}

TEST_F(UnconfirmedTest, RefusalsOfTheStoreCountToo) {
  BenchStream& stream = Welcomed();
  stream.Send(BatchFrame(Messages(1, 5, RefusedFault())));
  EXPECT_TRUE(stream.reading());
  server().Commit();
  EXPECT_EQ(stream.TakeLines().back(), "ack 5 judged 5");
  EXPECT_EQ(stream.end(), EndAt(5));
}

TEST_F(UnconfirmedTest, AHelloThatConfirmsThemGoesOn) {
  FillTheBound();
  BenchStream& next = server().Connect(SessionOf(1), 5, 5);
  EXPECT_THAT(next.TakeLines(), ElementsAre("welcome 5", "ack 5 judged 5"));
  next.Send(BatchFrame(Messages(6, 9, BadFault())));
  server().Commit();
  EXPECT_TRUE(next.reading());
  next.Send(BatchFrame({{10, Fault()}, {11, BadFault()}}));
  server().Commit();
  EXPECT_EQ(next.end(), EndAt(5));
  EXPECT_THAT(Stored(1), ElementsAre(10));
}

TEST_F(UnconfirmedTest, AHelloThatConfirmsSomeHasRoomForAsMany) {
  FillTheBound();
  BenchStream& next = server().Connect(SessionOf(1), 2, 2);
  EXPECT_THAT(next.TakeLines(),
              ElementsAre("welcome 5", BadReject(3), BadReject(4), BadReject(5), "ack 5 judged 5"));
  next.Send(BatchFrame({{6, BadFault()}}));
  EXPECT_TRUE(next.reading());
  next.Send(BatchFrame({{7, BadFault()}}));
  EXPECT_FALSE(next.reading());
}

TEST_F(UnconfirmedTest, AHelloThatConfirmsTooLittleIsToldAllAgainAndEnds) {
  FillTheBound();
  BenchStream& next = server().Connect(SessionOf(1));
  EXPECT_THAT(next.TakeLines(), ElementsAre("welcome 5", BadReject(1), BadReject(2), BadReject(3),
                                            BadReject(4), BadReject(5), "ack 5 judged 5"));
  EXPECT_EQ(next.end(), EndAt(5));
  EXPECT_EQ(server().probe().unconfirmed_total.value(), 2);
}

TEST_F(UnconfirmedTest, AnotherProcessKnowsThemFromTheStore) {
  FillTheBound();
  Start();
  BenchStream& next = server().Connect(SessionOf(1));
  EXPECT_EQ(next.TakeLines().back(), "ack 5 judged 5");
  EXPECT_EQ(next.end(), EndAt(5));
  BenchStream& confirming = server().Connect(SessionOf(1), 5, 5);
  EXPECT_TRUE(confirming.reading());
}

TEST_F(UnconfirmedTest, ThoseThatAreYetToBeReadCountToo) {
  FillTheBound();
  limits_.session.open_rejects_max = 2;
  limits_.session.reject_page_max = 2;
  Start();
  BenchStream& next = server().Connect(SessionOf(1));
  EXPECT_THAT(next.TakeLines(),
              ElementsAre("welcome 5", BadReject(1), BadReject(2), "ack 2 judged 2"));
  EXPECT_FALSE(next.reading());
  EXPECT_EQ(next.end(), "") << "it is told them first";
  server().Commit();
  EXPECT_THAT(next.TakeLines(), ElementsAre(BadReject(3), BadReject(4), "ack 4 judged 4",
                                            BadReject(5), "ack 5 judged 5"));
  EXPECT_EQ(next.end(), EndAt(5));
}

TEST_F(UnconfirmedTest, OtherSessionsOfTheRobotCountByThemselves) {
  FillTheBound();
  BenchStream& other = server().Connect(SessionOf(2));
  other.Send(BatchFrame(Messages(1, 4, BadFault())));
  EXPECT_TRUE(other.reading());
}

TEST_F(UnconfirmedTest, WhileTheStoreIsAwayItEndsInTimeAndNothingIsLost) {
  BenchStream& stream = Welcomed();
  server().StoreAway();
  stream.Send(BatchFrame(Messages(1, 6, BadFault())));
  server().Pass(limits_.session.drain_timeout - milliseconds(1));
  EXPECT_EQ(stream.end(), "");
  server().Pass(milliseconds(1));
  EXPECT_EQ(stream.end(), "UNAVAILABLE: not all was settled within drain.timeout");
  server().StoreBack();
  server().Commit();
  EXPECT_EQ(server().counts().rejected, 5U);
  BenchStream& next = server().Connect(SessionOf(1));
  EXPECT_EQ(next.TakeLines().back(), "ack 5 judged 5");
}

TEST_F(UnconfirmedTest, AnAgentThatTakesThemSlowlyIsGivenTheTime) {
  BenchStream& stream = Welcomed();
  stream.StopReading();
  stream.Send(BatchFrame(Messages(1, 5, BadFault())));
  server().Commit();
  for (int i = 0; i < 4; ++i) {
    server().Pass(limits_.session.drain_timeout - milliseconds(1));
    EXPECT_EQ(stream.end(), "");
    stream.ReadOne();
  }
  stream.ReadAgain();
  EXPECT_EQ(stream.TakeLines().back(), "ack 5 judged 5");
  EXPECT_EQ(stream.end(), EndAt(5));
}

TEST_F(UnconfirmedTest, AnAgentThatTakesNothingIsNotWaitedForForEver) {
  BenchStream& stream = Welcomed();
  stream.StopReading();
  stream.Send(BatchFrame(Messages(1, 5, BadFault())));
  server().Commit();
  server().Pass(limits_.session.drain_timeout);
  EXPECT_EQ(stream.end(), "UNAVAILABLE: not all was settled within drain.timeout");
}

TEST_F(UnconfirmedTest, AStreamThatIsHeldBackAtTheBoundEndsOnceItGoesOn) {
  limits_.session.in_flight_uplinks_max = 3;
  BenchStream& stream = Welcomed();
  stream.Send(BatchFrame(Messages(1, 7, BadFault())));
  EXPECT_EQ(server().counts().received, 3U);
  server().Commit();
  EXPECT_EQ(server().counts().received, 5U);
  EXPECT_EQ(stream.TakeLines().back(), "ack 5 judged 5");
  EXPECT_EQ(stream.end(), EndAt(5));
}

TEST_F(UnconfirmedTest, ADrainThatComesMeanwhileEndsItToo) {
  BenchStream& stream = Welcomed();
  stream.Send(BatchFrame(Messages(1, 5, BadFault())));
  stream.Drain(milliseconds(1000));
  server().Commit();
  EXPECT_EQ(stream.TakeLines().back(), "ack 5 judged 5");
  EXPECT_EQ(stream.end(), EndAt(5));
}

/// With the numbers that are in force.
class UnconfirmedByDefaultTest : public SessionTest {
 protected:
  static constexpr model::Seq kMax = storage::kQuarantineRowsPerRobotMax;
};

TEST_F(UnconfirmedByDefaultTest, TenThousandEndAStreamAndTheNextOneGoesOn) {
  BenchStream& stream = server().Connect(SessionOf(1));
  for (model::Seq first = 1; first <= kMax; first += 250) {
    // Not all in one second, which would be held back as malformed.
    if (first % 1000 == 1) server().Pass(std::chrono::seconds(1));
    EXPECT_TRUE(stream.reading()) << first;
    stream.Send(BatchFrame(Messages(first, first + 249, BadFault())));
    server().Commit();
  }
  EXPECT_EQ(stream.TakeLines().back(), "ack 10000 judged 10000");
  EXPECT_THAT(stream.end(), ::testing::StartsWith("UNAVAILABLE: 10000 Rejects"));
  server().Pass(std::chrono::seconds(1));
  server().Commit();
  BenchStream& next = server().Connect(SessionOf(1), kMax, kMax);
  EXPECT_THAT(next.TakeLines(), ElementsAre("welcome 10000", "ack 10000 judged 10000"));
  next.Send(BatchFrame({{kMax + 1, BadFault()}, {kMax + 2, Fault()}}));
  server().Commit();
  EXPECT_THAT(Stored(1), ElementsAre(kMax + 2));
  EXPECT_TRUE(next.reading());
}

}  // namespace
}  // namespace uplink::session
