// What a robot is asked for that the store lacks of it, and when.
#include "schema/encode.h"
#include "tests/unit/schema/samples.h"
#include "tests/unit/server/session/session_test.h"

namespace uplink::session {
namespace {

using storage::LatestKind;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

constexpr const char* kAskedForAll = "resend AGENT_INFO CURRENT_SETTINGS UI_CAPABILITIES";
constexpr milliseconds kGrace = kResendGrace;
constexpr milliseconds kEvery = robot::kResendEvery;
constexpr milliseconds kLeast{1};

std::string Info() { return schema::Encode(test::SampleAgentInfo()); }
std::string Settings() { return schema::Encode(test::SampleSettings()); }
std::string Capabilities() { return schema::Encode(test::SampleCapabilities()); }
std::string BadSettings() {
  return schema::Encode(model::CurrentSettings{{{"speed", 1.5}, {"speed", 2.5}}});
}

class ResendTest : public SessionTest {
 protected:
  /// A stream that was welcomed, which is all that it said.
  BenchStream& Welcomed(std::uint8_t session = 1) {
    BenchStream& stream = server().Connect(SessionOf(session));
    EXPECT_THAT(stream.TakeAllLines(), Contains(HasSubstr("welcome")));
    return stream;
  }
  /// The same while the store is away.
  BenchStream& WelcomedLate() {
    BenchStream& stream = server().Connect(SessionOf(1));
    server().Pass(kWelcomeWait);
    EXPECT_THAT(stream.TakeAllLines(), Contains(HasSubstr("welcome")));
    return stream;
  }
  BenchStream& Asked() {
    BenchStream& stream = Welcomed();
    server().Pass(kGrace);
    EXPECT_THAT(stream.TakeAllLines(), ElementsAre(kAskedForAll));
    return stream;
  }
  /// What the stream said, after commits, but for Acks and Rejects.
  std::vector<std::string> Requests(BenchStream& stream) {
    server().Commit();
    std::vector<std::string> requests = stream.TakeAllLines();
    std::erase_if(requests, [](const std::string& line) { return !line.starts_with("resend"); });
    return requests;
  }
  std::int64_t Asks(LatestKind kind) {
    return server().probe().resend_requests_total[static_cast<std::size_t>(kind)].value();
  }
  std::int64_t Unanswered(LatestKind kind) {
    return server().probe().resend_unanswered[static_cast<std::size_t>(kind)].value();
  }
};

TEST_F(ResendTest, AFirstConnectIsAskedForAllAfterTheGrace) {
  BenchStream& stream = Welcomed();
  server().Pass(kGrace - kLeast);
  EXPECT_THAT(stream.TakeAllLines(), IsEmpty());
  EXPECT_EQ(Asks(LatestKind::kSettings), 0);
  server().Pass(kLeast);
  EXPECT_THAT(stream.TakeAllLines(), ElementsAre(kAskedForAll));
  for (const LatestKind kind : storage::kEachLatestKind) {
    EXPECT_EQ(Asks(kind), 1);
    EXPECT_EQ(Unanswered(kind), 1);
  }
}

TEST_F(ResendTest, NothingIsAskedForThatTheStoreHas) {
  Welcomed().Send(BatchFrame({{1, Info()}, {2, Settings()}, {3, Capabilities()}}));
  server().Commit();
  Start();
  BenchStream& stream = Welcomed(2);
  server().Pass(kGrace);
  server().Pass(kEvery);
  EXPECT_THAT(Requests(stream), IsEmpty());
  EXPECT_FALSE(stream.session().deadline()) << "nor is there anything to wait for";
}

TEST_F(ResendTest, OnlyWhatTheStoreLacksIsAskedFor) {
  Welcomed().Send(BatchFrame({{1, Info()}, {2, Capabilities()}}));
  server().Commit();
  Start();
  BenchStream& stream = Welcomed();
  server().Pass(kGrace);
  EXPECT_THAT(Requests(stream), ElementsAre("resend CURRENT_SETTINGS"));
}

TEST_F(ResendTest, WhatAStoreLostIsAskedFor) {
  Welcomed().Send(BatchFrame({{1, Info()}, {2, Settings()}, {3, Capabilities()}}));
  server().Commit();
  database_.EraseLatest(kRobot, LatestKind::kAgentInfo);
  BenchStream& stream = Welcomed();
  server().Pass(kGrace);
  EXPECT_THAT(Requests(stream), ElementsAre("resend AGENT_INFO"));
}

TEST_F(ResendTest, WhatAStoreLosesBehindAnOpenStreamIsAskedForOnTheNextOne) {
  BenchStream& open = Welcomed();
  open.Send(BatchFrame({{1, Info()}, {2, Settings()}, {3, Capabilities()}}));
  server().Commit();
  database_.EraseLatest(kRobot, LatestKind::kSettings);
  open.Send(BatchFrame({{4, Fault()}}));
  server().Pass(kEvery);
  EXPECT_THAT(Requests(open), IsEmpty()) << "the store says what it has when a stream begins";
  EXPECT_EQ(open.end(), "");
  BenchStream& next = Welcomed();
  server().Pass(kGrace);
  EXPECT_THAT(Requests(next), ElementsAre("resend CURRENT_SETTINGS"));
}

TEST_F(ResendTest, ALossThatTakesTheRobotTooEndsTheStreamAndIsAskedFor) {
  BenchStream& open = Welcomed();
  open.Send(BatchFrame({{1, Info()}, {2, Settings()}, {3, Capabilities()}}));
  server().Commit();
  database_.DeleteRobotRow(kRobot);
  for (const LatestKind kind : storage::kEachLatestKind) database_.EraseLatest(kRobot, kind);
  open.Send(BatchFrame({{4, Fault()}}));
  server().Commit();
  EXPECT_EQ(open.end(), "ABORTED: superseded") << "by the next durable message";
  BenchStream& next = Welcomed();
  server().Pass(kGrace);
  EXPECT_THAT(Requests(next), ElementsAre(kAskedForAll));
}

TEST_F(ResendTest, WhatComesWithinTheGraceIsNotAskedFor) {
  BenchStream& stream = Welcomed();
  stream.Send(BatchFrame({{1, Settings()}}));
  server().Pass(kGrace);
  EXPECT_THAT(Requests(stream), ElementsAre("resend AGENT_INFO UI_CAPABILITIES"));
}

TEST_F(ResendTest, TheNextMessageOfTheKindAnswers) {
  BenchStream& stream = Asked();
  stream.Send(BatchFrame({{1, Settings()}, {2, Fault()}}));
  EXPECT_EQ(Unanswered(LatestKind::kSettings), 0) << "a commit is not waited for";
  EXPECT_EQ(Unanswered(LatestKind::kAgentInfo), 1);
  server().Pass(kEvery);
  EXPECT_THAT(Requests(stream), ElementsAre("resend AGENT_INFO UI_CAPABILITIES"));
  stream.Send(BatchFrame({{3, Info()}, {4, Capabilities()}}));
  server().Pass(kEvery);
  EXPECT_THAT(Requests(stream), IsEmpty());
  for (const LatestKind kind : storage::kEachLatestKind) EXPECT_EQ(Unanswered(kind), 0);
}

TEST_F(ResendTest, ARejectedMessageAnswersNothing) {
  BenchStream& stream = Asked();
  stream.Send(BatchFrame({{1, BadSettings()}}));
  EXPECT_THAT(stream.TakeAllLines(), Contains(HasSubstr("reject 1 duplicate_key")));
  server().Pass(kEvery);
  EXPECT_THAT(Requests(stream), ElementsAre(kAskedForAll));
}

TEST_F(ResendTest, ADuplicateOfWhatTheStoreKnewAnswersNothing) {
  Welcomed().Send(BatchFrame({{1, Settings()}}));
  server().Commit();
  database_.EraseLatest(kRobot, LatestKind::kSettings);
  Start().StoreAway();
  BenchStream& stream = WelcomedLate();
  stream.Send(BatchFrame({{1, Settings()}}));
  server().StoreBack();
  EXPECT_THAT(Requests(stream), IsEmpty());
  server().Pass(kGrace);
  EXPECT_THAT(Requests(stream), ElementsAre(kAskedForAll));
}

TEST_F(ResendTest, IsRepeatedOncePerMinuteWhileUnanswered) {
  BenchStream& stream = Asked();
  for (int i = 2; i <= 4; ++i) {
    server().Pass(kEvery - kLeast);
    EXPECT_THAT(Requests(stream), IsEmpty());
    server().Pass(kLeast);
    EXPECT_THAT(Requests(stream), ElementsAre(kAskedForAll));
    EXPECT_EQ(Asks(LatestKind::kUiCapabilities), i);
    EXPECT_EQ(Unanswered(LatestKind::kUiCapabilities), 1) << "one robot, however often";
  }
}

TEST_F(ResendTest, IsNoMoreFrequentForARobotThatReconnects) {
  Asked().Break();
  EXPECT_EQ(Unanswered(LatestKind::kSettings), 0) << "it is not connected";
  milliseconds left = kEvery;
  for (std::uint8_t session = 2; session < 6; ++session) {
    BenchStream& again = Welcomed(session);
    EXPECT_EQ(Unanswered(LatestKind::kSettings), 1) << "it was asked before";
    server().Pass(kGrace);
    left -= kGrace;
    EXPECT_THAT(Requests(again), IsEmpty());
    again.Break();
  }
  BenchStream& last = Welcomed();
  server().Pass(left - kLeast);
  EXPECT_THAT(Requests(last), IsEmpty());
  server().Pass(kLeast);
  EXPECT_THAT(Requests(last), ElementsAre(kAskedForAll));
}

TEST_F(ResendTest, IsNoMoreFrequentForARobotThatIsTakenOver) {
  BenchStream& older = Asked();
  BenchStream& newer = Welcomed(2);
  EXPECT_EQ(older.end(), "ABORTED: superseded");
  EXPECT_EQ(Unanswered(LatestKind::kSettings), 1);
  server().Pass(kEvery - kLeast);
  EXPECT_THAT(Requests(newer), IsEmpty());
  server().Pass(kLeast);
  EXPECT_THAT(Requests(newer), ElementsAre(kAskedForAll));
  EXPECT_THAT(Requests(older), IsEmpty());
}

TEST_F(ResendTest, NothingIsAskedForUntilTheStoreAnswers) {
  server().StoreAway();
  BenchStream& stream = WelcomedLate();
  server().Pass(kGrace);
  server().Pass(kEvery);
  EXPECT_THAT(stream.TakeAllLines(), IsEmpty());
  server().StoreBack();
  EXPECT_THAT(Requests(stream), ElementsAre(kAskedForAll)) << "the grace is over";
}

TEST_F(ResendTest, WhatWaitsForItsCommitIsNotAskedFor) {
  server().StoreAway();
  BenchStream& first = WelcomedLate();
  first.Send(BatchFrame({{1, Settings()}}));
  first.Break();
  BenchStream& second = WelcomedLate();
  second.Send(BatchFrame({{2, Info()}}));
  server().StoreBack();
  server().Commit();
  server().Pass(kGrace);
  EXPECT_THAT(Requests(second), ElementsAre("resend UI_CAPABILITIES"));
}

TEST_F(ResendTest, AStreamThatIsReadNoMoreIsAskedForNothing) {
  BenchStream& closing = Welcomed();
  closing.Send(BatchFrame({{1, Fault()}}));
  closing.HalfClose();
  server().Pass(kGrace);
  EXPECT_THAT(Requests(closing), IsEmpty());
  EXPECT_EQ(closing.end(), "OK");

  BenchStream& drained = Welcomed();
  drained.Send(BatchFrame({{2, Fault()}}));
  drained.Drain(2 * kGrace);
  server().Pass(kGrace);
  EXPECT_THAT(Requests(drained), IsEmpty());
  EXPECT_EQ(drained.end(), "UNAVAILABLE: the server drains");
}

TEST_F(ResendTest, ItWaitsBehindWhatAnAgentDoesNotRead) {
  BenchStream& stream = Welcomed();
  stream.StopReading();
  stream.Send(BatchFrame({{1, BadFault()}, {2, BadFault()}}));
  server().Pass(kGrace);
  EXPECT_EQ(Asks(LatestKind::kSettings), 0);
  stream.ReadAgain();
  EXPECT_THAT(stream.TakeAllLines(), Not(Contains(kAskedForAll)));
  server().Pass(kGrace);
  EXPECT_THAT(Requests(stream), ElementsAre(kAskedForAll));
}

}  // namespace
}  // namespace uplink::session
