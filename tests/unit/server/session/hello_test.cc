// The first frame: what is refused, with which words, and what Welcome says.
#include <string>

#include "tests/unit/server/session/session_test.h"

namespace uplink::session {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

class HelloTest : public SessionTest {
 protected:
  /// How a stream ends whose first frame is this.
  std::string EndOf(const v1::RelayRequest& frame) {
    BenchStream& stream = server().Open();
    stream.Send(frame);
    server().Commit();
    EXPECT_TRUE(stream.end().empty() || stream.TakeLines().empty());
    return stream.end();
  }
  v1::RelayRequest frame_ = HelloFrame(SessionOf(1));
  v1::Hello& hello_ = *frame_.mutable_hello();
};

TEST_F(HelloTest, IsAnsweredByWelcomeAndAnAck) {
  BenchStream& stream = server().Connect(SessionOf(1));
  EXPECT_THAT(stream.TakeLines(), ElementsAre("welcome 0", "ack 0 judged 0"));
  EXPECT_TRUE(stream.reading());
}

TEST_F(HelloTest, WelcomeTellsTheLimitsAndTheTime) {
  limits_.session.payload_bytes_max = 1000;
  limits_.session.message_bytes_max = 2000;
  limits_.session.batch_uplinks_max = 3;
  limits_.session.extras_items_max = 4;
  limits_.session.in_flight_uplinks_max = 5;
  limits_.session.frame_bytes_max = 6000;
  limits_.session.server_version = "1.2.3";
  BenchStream& stream = server().Connect(SessionOf(1));
  const v1::Welcome& welcome = stream.frames().front().welcome();
  EXPECT_EQ(welcome.robot_ruri(), kRobot);
  EXPECT_EQ(welcome.server_version(), "1.2.3");
  EXPECT_EQ(welcome.server_unix_ms(), UnixMs(clock_.System()));
  EXPECT_EQ(welcome.limits().payload_bytes_max(), 2000U) << "the largest of the size limits";
  EXPECT_EQ(welcome.limits().batch_uplinks_max(), 3U);
  EXPECT_EQ(welcome.limits().extras_items_max(), 4U);
  EXPECT_EQ(welcome.limits().in_flight_uplinks_max(), 5U);
  EXPECT_EQ(welcome.limits().frame_bytes_max(), 6000U);
}

TEST_F(HelloTest, MustComeWithinItsTime) {
  BenchStream& prompt = server().Open();
  server().Pass(kHelloWait - milliseconds(1));
  EXPECT_EQ(prompt.end(), "");
  prompt.Send(frame_);
  server().Commit();
  BenchStream& silent = server().Open("rcan://silent");
  server().Pass(kHelloWait);
  EXPECT_EQ(silent.end(), "INVALID_ARGUMENT: frame 1: no hello within 10 s");
  EXPECT_EQ(prompt.end(), "") << "a stream that said hello stays";
}

TEST_F(HelloTest, MustComeSoonerWhileOthersWaitForAPlace) {
  BenchStream& early = server().Open("rcan://early");
  server().Pass(kHelloWaitPressed + kHelloLook);
  EXPECT_EQ(early.end(), "");
  server().pressed = true;
  BenchStream& late = server().Open("rcan://late");
  server().Pass(kHelloLook);
  EXPECT_EQ(early.end(), "INVALID_ARGUMENT: frame 1: no hello within 3 s");
  EXPECT_EQ(late.end(), "");
  server().Pass(kHelloWaitPressed - kHelloLook);
  EXPECT_EQ(late.end(), "INVALID_ARGUMENT: frame 1: no hello within 3 s");
}

TEST_F(HelloTest, ASessionIdHasSixteenBytes) {
  hello_.set_session_id(std::string(15, 'x'));
  EXPECT_EQ(EndOf(frame_),
            "INVALID_ARGUMENT: frame 1: hello.session_id: 15 bytes, it must have 16");
  hello_.set_session_id(std::string(17, 'x'));
  EXPECT_EQ(EndOf(frame_),
            "INVALID_ARGUMENT: frame 1: hello.session_id: 17 bytes, it must have 16");
  hello_.clear_session_id();
  EXPECT_EQ(EndOf(frame_), "INVALID_ARGUMENT: frame 1: hello.session_id: 0 bytes, it must have 16");
  EXPECT_EQ(server().probe().protocol_errors_total.value(), 3);
}

TEST_F(HelloTest, ASchemaMustBeGiven) {
  hello_.clear_schema();
  EXPECT_EQ(EndOf(frame_), "INVALID_ARGUMENT: frame 1: hello.schema: it must be given");
}

TEST_F(HelloTest, AnUnknownSchemaIsRefused) {
  hello_.set_schema(static_cast<v1::PayloadSchema>(99));
  EXPECT_EQ(EndOf(frame_),
            "INVALID_ARGUMENT: frame 1: hello.schema: 99 is not a schema that this server knows");
}

TEST_F(HelloTest, AnAgentVersionHasAtMost256Bytes) {
  hello_.set_agent_version(std::string(256, 'v'));
  EXPECT_EQ(EndOf(frame_), "");
  hello_.set_agent_version(std::string(257, 'v'));
  EXPECT_EQ(EndOf(frame_),
            "INVALID_ARGUMENT: frame 1: hello.agent_version: 257 bytes, the limit is 256");
}

TEST_F(HelloTest, ARobotRuriHasAtMost256Bytes) {
  hello_.set_robot_ruri(std::string(257, 'r'));
  EXPECT_EQ(EndOf(frame_),
            "INVALID_ARGUMENT: frame 1: hello.robot_ruri: 257 bytes, the limit is 256");
  const std::string longest(256, 'r');
  hello_.set_robot_ruri(longest);
  BenchStream& stream = server().Open(longest);
  stream.Send(frame_);
  server().Commit();
  EXPECT_THAT(stream.TakeLines(), ElementsAre("welcome 0", "ack 0 judged 0"));
}

TEST_F(HelloTest, JudgedIsNotBelowSettled) {
  hello_.set_settled_seq(8);
  hello_.set_judged_seq(7);
  EXPECT_EQ(EndOf(frame_), "INVALID_ARGUMENT: frame 1: hello.judged_seq: 7 is below settled_seq 8");
  hello_.set_judged_seq(8);
  EXPECT_EQ(EndOf(frame_), "");
}

TEST_F(HelloTest, NumbersEndAtTwoToThe63) {
  hello_.set_settled_seq(model::kSeqMax + 1);
  hello_.set_judged_seq(model::kSeqMax + 1);
  EXPECT_EQ(EndOf(frame_),
            "INVALID_ARGUMENT: frame 1: hello.settled_seq: 9223372036854775808 is over 2^63-1");
  hello_.set_settled_seq(model::kSeqMax);
  EXPECT_EQ(EndOf(frame_),
            "INVALID_ARGUMENT: frame 1: hello.judged_seq: 9223372036854775808 is over 2^63-1");
  hello_.set_judged_seq(model::kSeqMax);
  EXPECT_EQ(EndOf(frame_), "");
}

TEST_F(HelloTest, OwnRuriMayBeNamed) {
  hello_.set_robot_ruri(std::string(kRobot));
  EXPECT_EQ(EndOf(frame_), "");
}

TEST_F(HelloTest, AnotherRobotsRuriIsDenied) {
  hello_.set_robot_ruri("rcan://bench/2");
  EXPECT_EQ(EndOf(frame_),
            "PERMISSION_DENIED: the certificate of rcan://bench/1 may not speak for "
            "hello.robot_ruri rcan://bench/2");
  EXPECT_EQ(server().fleet().size(), 0U);
  EXPECT_EQ(server().probe().refused_identity_total.value(), 1);
  EXPECT_EQ(server().probe().protocol_errors_total.value(), 0);
}

TEST_F(HelloTest, AGatewayMustNameItsRobot) {
  BenchStream& stream = server().OpenAs({.role = identity::Role::kGateway, .fleet = "bench"});
  stream.Send(frame_);
  EXPECT_EQ(stream.end(),
            "INVALID_ARGUMENT: frame 1: hello.robot_ruri: a gateway must name the robot that it "
            "speaks for");
}

TEST_F(HelloTest, OtherRolesAreNoRobots) {
  for (const identity::Role role : identity::kAskingRoles) {
    BenchStream& stream = server().OpenAs({.role = role, .fleet = "bench"});
    stream.Send(frame_);
    EXPECT_EQ(stream.end(), "UNAUTHENTICATED: the certificate is of role " +
                                std::string(identity::ToText(role)) +
                                "; the relay takes robots and gateways alone");
  }
}

TEST_F(HelloTest, RobotsMaxAdmitsNoMore) {
  limits_.robots_max = 1;
  server().Connect(SessionOf(1));
  BenchStream& refused = server().Connect(SessionOf(1), 0, 0, "rcan://bench/2");
  EXPECT_EQ(refused.end(),
            "RESOURCE_EXHAUSTED: the server admits no more than 1 robots (limits.robots_max)");
  EXPECT_EQ(server().probe().refused_full_total.value(), 1);
  EXPECT_EQ(server().probe().protocol_errors_total.value(), 0);
  BenchStream& known = server().Connect(SessionOf(1));
  EXPECT_THAT(known.TakeLines(), ElementsAre("welcome 0", "ack 0 judged 0"));
}

TEST_F(HelloTest, ANinthSessionIsRefusedWhileEightWait) {
  server().StoreAway();
  for (std::uint8_t session = 1; session <= robot::kSessionsMax; ++session) {
    BenchStream& stream = server().Connect(SessionOf(session));
    server().Pass(kWelcomeWait);
    stream.Send(BatchFrame({{1, Fault()}}));
    stream.Break();
  }
  BenchStream& ninth = server().Connect(SessionOf(9));
  EXPECT_EQ(ninth.end(), "RESOURCE_EXHAUSTED: all 8 sessions of the robot wait for the store");
  EXPECT_THAT(ninth.TakeLines(), IsEmpty());
  server().StoreBack();
  server().Commit();
  EXPECT_EQ(server().counts().stored, 8U);
  BenchStream& later = server().Connect(SessionOf(9));
  EXPECT_THAT(later.TakeLines(), ElementsAre("welcome 0", "ack 0 judged 0"));
}

TEST_F(HelloTest, ANinthSessionReplacesTheOneUnusedForLongest) {
  for (std::uint8_t session = 1; session <= robot::kSessionsMax + 1; ++session) {
    server().Connect(SessionOf(session)).Break();
    server().Pass(milliseconds(1));
  }
  const auto held = server().robot().sessions.Held();
  EXPECT_EQ(held.size(), robot::kSessionsMax);
  EXPECT_THAT(held, ::testing::Not(::testing::Contains(SessionOf(1))));
}

TEST_F(HelloTest, ABatchBeforeWelcomeStaysUnread) {
  BenchStream& stream = server().Open();
  stream.Send(frame_);
  EXPECT_FALSE(stream.reading());
  server().Commit();
  EXPECT_TRUE(stream.reading());
}

TEST_F(HelloTest, WelcomeWaitsNoLongerThanASecondForTheStore) {
  server().StoreAway();
  BenchStream& stream = server().Connect(SessionOf(1), 3, 4);
  server().Pass(milliseconds(999));
  EXPECT_THAT(stream.TakeLines(), IsEmpty());
  server().Pass(milliseconds(1));
  EXPECT_THAT(stream.TakeLines(), ElementsAre("welcome 3", "ack 3 judged 4"));
}

}  // namespace
}  // namespace uplink::session
