// Streams of gateways: for whom they may speak, within which bounds, and who hears of it.
#include <string>

#include "server/identity/pem.h"
#include "tests/support/certificates.h"
#include "tests/unit/server/session/session_test.h"

namespace uplink::session {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr std::string_view kSubject = "CN=hall,OU=gateway,O=bench";

class GatewayTest : public SessionTest {
 protected:
  /// How often streams come is not the matter here.
  GatewayTest() { limits_.session.reconnects.per_minute = robot::kStreamTimesMax; }

  /// A gateway's stream for this robot; `ruris` are those of its certificate.
  BenchStream& ConnectVia(std::string_view ruri, std::vector<std::string> ruris = {},
                          std::string_view subject = kSubject) {
    BenchStream& stream =
        server().OpenAs({.role = identity::Role::kGateway,
                         .fleet = "bench",
                         .gateway = {.subject = std::string(subject), .ruris = std::move(ruris)}});
    v1::RelayRequest frame = HelloFrame(SessionOf(1));
    frame.mutable_hello()->set_robot_ruri(std::string(ruri));
    stream.Send(frame);
    server().Commit();
    return stream;
  }
  /// A stream of the robot's own certificate, which is of that fleet.
  BenchStream& ConnectOfFleet(std::string_view ruri, std::string_view fleet) {
    BenchStream& stream = server().OpenAs(
        {.role = identity::Role::kRobot, .fleet = std::string(fleet), .ruri = std::string(ruri)});
    stream.Send(HelloFrame(SessionOf(1)));
    server().Commit();
    return stream;
  }
  std::string GatewayOf(std::string_view ruri) {
    const robot::SessionView view = server().robot(ruri).sessions.View();
    return view.connected ? view.gateway : "";
  }
};

TEST_F(GatewayTest, SpeaksForTheRobotsThatItsCertificateNames) {
  const std::vector<std::string> named{"rcan://a/1", "rcan://a/2"};
  for (const std::string& ruri : named) {
    BenchStream& stream = ConnectVia(ruri, named);
    EXPECT_THAT(stream.TakeLines(), ElementsAre("welcome 0", "ack 0 judged 0"));
    EXPECT_EQ(stream.frames().front().welcome().robot_ruri(), ruri);
    EXPECT_EQ(stream.session().ruri(), ruri);
    EXPECT_EQ(server().robot(ruri).id()->fleet, "bench");
    EXPECT_EQ(GatewayOf(ruri), kSubject);
  }
}

TEST_F(GatewayTest, SpeaksForNobodyElse) {
  BenchStream& stream = ConnectVia("rcan://a/3", {"rcan://a/1", "rcan://a/2"});
  EXPECT_EQ(stream.end(),
            "PERMISSION_DENIED: the certificate of gateway CN=hall,OU=gateway,O=bench may not "
            "speak for hello.robot_ruri rcan://a/3");
  EXPECT_EQ(server().fleet().size(), 0U);
  EXPECT_EQ(server().probe().refused_identity_total.value(), 1);
}

TEST_F(GatewayTest, SpeaksForNoTwin) {
  const std::string twin = "rcan://local.rcan/cyberwave/twin.site/T";
  const std::string refused = "PERMISSION_DENIED: hello.robot_ruri " + twin +
                              " is a twin's, and twins are heard through their broker alone";
  EXPECT_EQ(ConnectVia(twin).end(), refused) << "by its fleet's name";
  EXPECT_EQ(ConnectVia(twin, {twin}).end(), refused) << "by the robot's";
  EXPECT_EQ(server().fleet().size(), 0U);
  EXPECT_EQ(server().probe().refused_identity_total.value(), 2);
}

TEST_F(GatewayTest, WithoutNamesSpeaksForItsWholeFleet) {
  EXPECT_THAT(ConnectVia("rcan://a/1").TakeLines(), ElementsAre("welcome 0", "ack 0 judged 0"));
  EXPECT_THAT(ConnectVia("rcan://a/2").TakeLines(), ElementsAre("welcome 0", "ack 0 judged 0"));
}

TEST_F(GatewayTest, ARobotThatItNamesIsARuri) {
  const auto end = [this](std::string_view ruri) { return ConnectVia(ruri).end(); };
  EXPECT_EQ(end("http://a"),
            "INVALID_ARGUMENT: frame 1: hello.robot_ruri: it does not begin rcan://");
  EXPECT_EQ(end("rcan://"), "INVALID_ARGUMENT: frame 1: hello.robot_ruri: it names nothing");
  EXPECT_EQ(end("rcan://a b"),
            "INVALID_ARGUMENT: frame 1: hello.robot_ruri: it holds white space, a control "
            "character or a byte beyond ASCII: rcan://a b");
  const std::string longest = "rcan://" + std::string(model::kRuriBytesMax - 7, 'r');
  EXPECT_EQ(end(longest + "r"),
            "INVALID_ARGUMENT: frame 1: hello.robot_ruri: 257 bytes, the limit is 256");
  EXPECT_EQ(server().fleet().size(), 0U);
  EXPECT_EQ(end(longest), "");
}

TEST_F(GatewayTest, DoesNotPullARobotOutOfAnotherFleet) {
  BenchStream& own = ConnectOfFleet("rcan://a/1", "south");
  own.HalfClose();
  EXPECT_EQ(own.end(), "OK");
  EXPECT_EQ(ConnectVia("rcan://a/1").end(),
            "PERMISSION_DENIED: the certificate of gateway CN=hall,OU=gateway,O=bench may not "
            "speak for hello.robot_ruri rcan://a/1: the robot is of another fleet, and the "
            "certificate does not name it");
  EXPECT_EQ(server().robot("rcan://a/1").id()->fleet, "south");
  EXPECT_EQ(server().probe().refused_identity_total.value(), 1);
}

constexpr std::string_view kOfAnotherFleet =
    "PERMISSION_DENIED: the certificate of gateway CN=hall,OU=gateway,O=bench may not speak for "
    "hello.robot_ruri rcan://a/1: the robot is of another fleet, and the certificate does not name "
    "it";

TEST_F(GatewayTest, DoesNotPullARobotOutOfTheFleetThatTheStoreKnows) {
  ConnectOfFleet("rcan://a/1", "south").Send(BatchFrame({{1, Fault()}}));
  server().Commit();
  Start();
  ASSERT_EQ(server().fleet().size(), 0U) << "it is not in memory";
  BenchStream& refused = ConnectVia("rcan://a/1");
  EXPECT_EQ(refused.end(), kOfAnotherFleet);
  EXPECT_THAT(refused.TakeLines(), IsEmpty()) << "not even how far its session is";
  EXPECT_EQ(server().robot("rcan://a/1").id()->fleet, "south");
  EXPECT_FALSE(server().robot("rcan://a/1").HasStream());
  EXPECT_EQ(server().probe().refused_identity_total.value(), 1);
  EXPECT_EQ(ConnectVia("rcan://a/1").end(), kOfAnotherFleet);
  EXPECT_EQ(server().store().opens(), 1U) << "memory knows it now";
  EXPECT_THAT(ConnectOfFleet("rcan://a/1", "south").TakeLines(),
              ElementsAre("welcome 1", "ack 1 judged 1"));
  EXPECT_THAT(ConnectVia("rcan://a/1", {"rcan://a/1"}).TakeLines(),
              ElementsAre("welcome 1", "ack 1 judged 1"))
      << "by a certificate that names it the robot moves";
  EXPECT_EQ(server().robot("rcan://a/1").id()->fleet, "bench");
}

TEST_F(GatewayTest, AnotherProcessKeepsTheRobotThatItMayNotSpeakFor) {
  ConnectOfFleet("rcan://a/1", "south");
  BenchServer second(clock_, database_, 200, limits_);
  BenchStream& stream = second.OpenAs({.role = identity::Role::kGateway,
                                       .fleet = "bench",
                                       .gateway = {.subject = std::string(kSubject)}});
  v1::RelayRequest hello = HelloFrame(SessionOf(1));
  hello.mutable_hello()->set_robot_ruri("rcan://a/1");
  stream.Send(hello);
  second.Commit();
  EXPECT_EQ(stream.end(), kOfAnotherFleet);
  const robot::Robot& robot = server().robot("rcan://a/1");
  EXPECT_TRUE(robot.HasStream());
  EXPECT_NE(robot.state.held_since(), 0U);
}

TEST_F(GatewayTest, WhatItSentBeforeTheStoreAnsweredIsNotKept) {
  ConnectOfFleet("rcan://a/1", "south");
  Start().StoreAway();
  BenchStream& stream = ConnectVia("rcan://a/1");
  server().Pass(kWelcomeWait);
  EXPECT_THAT(stream.TakeLines(), Contains("welcome 0"));
  stream.Send(BatchFrame({{1, Fault()}, {2, Motion()}, {3, BadFault()}}));
  server().Commit();
  EXPECT_EQ(stream.end(), "") << "the fleet is not known yet";
  EXPECT_EQ(server().counts().in_flight, 2);
  server().StoreBack();
  server().Commit();
  EXPECT_EQ(stream.end(), kOfAnotherFleet);
  EXPECT_EQ(server().counts().in_flight, 0);
  EXPECT_EQ(server().counts().superseded, 2U);
  EXPECT_EQ(server().robot("rcan://a/1").id()->fleet, "south");
  server().robot("rcan://a/1").state.LookAt([](const robot::StateView& state) {
    EXPECT_FALSE(state.parts.motion) << "nor what it said live";
    EXPECT_EQ(state.presence, model::Presence::kUnknown);
  });
  EXPECT_TRUE(database_.Log("rcan://a/1", SessionOf(1)).stored.empty());
  EXPECT_THAT(ConnectOfFleet("rcan://a/1", "south").TakeLines(),
              ElementsAre("welcome 0", "ack 0 judged 0"))
      << "the one that may speak for the robot sends it again";
}

TEST_F(GatewayTest, WhatItSentForAnotherFleetGoesWhenTheRobotComesByItself) {
  ConnectOfFleet("rcan://a/1", "south");
  Start().StoreAway();
  BenchStream& through = ConnectVia("rcan://a/1");
  server().Pass(kWelcomeWait);
  through.Send(BatchFrame({{1, Fault("GATEWAYS")}, {2, Motion()}}));
  BenchStream& own = ConnectOfFleet("rcan://a/1", "south");
  EXPECT_EQ(through.end(), "ABORTED: superseded");
  EXPECT_EQ(server().counts().superseded, 1U);
  server().Pass(kWelcomeWait);
  own.Send(BatchFrame({{1, Fault("OWN")}}));
  server().StoreBack();
  server().Commit();
  EXPECT_EQ(own.end(), "");
  EXPECT_EQ(server().robot("rcan://a/1").id()->fleet, "south");
  const auto faults = server().store().FaultHistory({});
  ASSERT_TRUE(faults.ok());
  ASSERT_EQ(faults->rows.size(), 1U);
  EXPECT_EQ(faults->rows[0].fault.fault_id, "OWN");
  EXPECT_EQ(faults->rows[0].robot.fleet, "south");
}

TEST_F(GatewayTest, WhatItSentForTheRobotsOwnFleetIsKept) {
  Start().StoreAway();
  BenchStream& through = ConnectVia("rcan://a/1");
  server().Pass(kWelcomeWait);
  through.Send(BatchFrame({{1, Fault()}}));
  ConnectOfFleet("rcan://a/1", "bench");
  server().StoreBack();
  server().Commit();
  EXPECT_EQ(server().counts().superseded, 0U);
  EXPECT_THAT(database_.Log("rcan://a/1", SessionOf(1)).stored, ElementsAre(1));
}

TEST_F(GatewayTest, AMoveThatTheStoreWasNotToldStandsForTheGatewayOfTheNewFleet) {
  ConnectOfFleet("rcan://a/1", "south");
  Start().StoreAway();
  BenchStream& own = ConnectOfFleet("rcan://a/1", "bench");
  server().Pass(kWelcomeWait);
  own.Send(BatchFrame({{1, Fault()}}));
  BenchStream& through = ConnectVia("rcan://a/1");
  EXPECT_EQ(own.end(), "ABORTED: superseded");
  server().StoreBack();
  server().Commit();
  EXPECT_EQ(through.end(), "") << "the robot's own certificate had moved it";
  EXPECT_EQ(server().robot("rcan://a/1").id()->fleet, "bench");
  EXPECT_THAT(database_.Log("rcan://a/1", SessionOf(1)).stored, ElementsAre(1));
}

TEST_F(GatewayTest, AStreamThatWaitedIsRefusedIfTheRobotMovedMeanwhile) {
  limits_.session.reconnects.per_minute = 1;
  ConnectVia("rcan://a/1");
  BenchStream& waits = ConnectVia("rcan://a/1");
  EXPECT_THAT(waits.TakeLines(), IsEmpty());
  server().robot("rcan://a/1").SetFleet("south");
  server().Pass(std::chrono::seconds(5));
  server().Commit();
  EXPECT_EQ(waits.end(), kOfAnotherFleet);
}

TEST_F(GatewayTest, ACertificateThatNamesTheRobotDecidesItsFleet) {
  ConnectOfFleet("rcan://a/1", "south");
  EXPECT_THAT(ConnectVia("rcan://a/1", {"rcan://a/1"}).TakeLines(),
              ElementsAre("welcome 0", "ack 0 judged 0"));
  EXPECT_EQ(server().robot("rcan://a/1").id()->fleet, "bench");
  ConnectOfFleet("rcan://a/1", "south");
  EXPECT_EQ(server().robot("rcan://a/1").id()->fleet, "south") << "so does the robot's own";
}

TEST_F(GatewayTest, CompetesWithTheRobotsOwnStreamByTakeover) {
  BenchStream& own = server().Connect(SessionOf(1));
  EXPECT_EQ(GatewayOf(kRobot), "");
  BenchStream& through = ConnectVia(kRobot);
  EXPECT_EQ(own.end(), "ABORTED: superseded");
  EXPECT_EQ(GatewayOf(kRobot), kSubject);
  BenchStream& another = ConnectVia(kRobot, {}, "CN=yard");
  EXPECT_EQ(through.end(), "ABORTED: superseded");
  EXPECT_EQ(GatewayOf(kRobot), "CN=yard");
  server().Connect(SessionOf(1));
  server().Commit();
  EXPECT_EQ(another.end(), "ABORTED: superseded");
  EXPECT_EQ(GatewayOf(kRobot), "");
  EXPECT_EQ(server().probe().takeovers_total.value(), 3);
}

TEST_F(GatewayTest, IsTheRobotsAsLongAsItsStream) {
  BenchStream& stream = ConnectVia(kRobot);
  stream.Break();
  EXPECT_EQ(GatewayOf(kRobot), "");
}

TEST_F(GatewayTest, ARobotsStreamsWaitForEachOtherHoweverTheyCome) {
  limits_.session.reconnects.per_minute = 2;
  ConnectVia("rcan://a/1");
  server().Connect(SessionOf(1), 0, 0, "rcan://a/1");
  EXPECT_THAT(ConnectVia("rcan://a/1").TakeLines(), IsEmpty());
  EXPECT_EQ(server().probe().waiting.value(), 1);
  EXPECT_THAT(ConnectVia("rcan://a/2").TakeLines(), ElementsAre("welcome 0", "ack 0 judged 0"))
      << "its neighbours do not";
}

TEST_F(GatewayTest, BringsInNoMoreThanItsShareOfTheRobots) {
  limits_.robots_max = 4;
  for (const char* ruri : {"rcan://a/1", "rcan://a/2", "rcan://a/3"}) {
    EXPECT_EQ(ConnectVia(ruri).end(), "") << ruri;
  }
  EXPECT_EQ(ConnectVia("rcan://a/4").end(),
            "RESOURCE_EXHAUSTED: gateway CN=hall,OU=gateway,O=bench has brought in 3 robots, and "
            "may bring in no more");
  EXPECT_EQ(server().probe().refused_gateway_total.value(), 1);
  EXPECT_EQ(server().fleet().size(), 3U);
  EXPECT_EQ(ConnectVia("rcan://a/1").end(), "") << "those that it has go on";
  server().Connect(SessionOf(1), 0, 0, "rcan://own/1");
  EXPECT_EQ(server().fleet().size(), 4U) << "the rest is for others";
}

TEST_F(GatewayTest, RobotsThatItsCertificateNamesAreNotCounted) {
  limits_.robots_max = 2;
  const std::vector<std::string> named{"rcan://a/1", "rcan://a/2", "rcan://a/3"};
  EXPECT_EQ(ConnectVia(named[0], named).end(), "");
  EXPECT_EQ(ConnectVia(named[1], named).end(), "");
  EXPECT_EQ(ConnectVia(named[2], named).end(),
            "RESOURCE_EXHAUSTED: the server admits no more than 2 robots (limits.robots_max)");
}

TEST_F(GatewayTest, AtTwiceItsShareOfTheJournalItsNextRobotIsHeldBackAndNobodyElse) {
  limits_.journal.records_max = 8;
  limits_.journal.robot_share = 8;
  const std::vector<std::string> ruris{"rcan://a/1", "rcan://a/2", "rcan://a/3", "rcan://a/4",
                                       "rcan://a/5"};
  std::vector<BenchStream*> streams;
  streams.reserve(ruris.size());
  for (const std::string& ruri : ruris) streams.push_back(&ConnectVia(ruri));
  BenchStream& own = server().Connect(SessionOf(1), 0, 0, "rcan://own/1");
  for (BenchStream* stream : streams) stream->Send(BatchFrame({{1, Fault()}}));
  EXPECT_EQ(server().counts().received, 4U) << "a quarter of eight, twice";
  const auto held_back = [&](std::string_view ruri) {
    return server().robot(ruri).sessions.View().held_back;
  };
  EXPECT_EQ(held_back(ruris[3]), HeldBack::kNone);
  EXPECT_EQ(held_back(ruris[4]), HeldBack::kJournal);
  own.Send(BatchFrame({{1, Fault()}}));
  EXPECT_EQ(server().counts().received, 5U);
  EXPECT_TRUE(own.reading());
  server().Commit();
  EXPECT_EQ(server().counts().stored, 6U) << "it was woken";
  EXPECT_EQ(held_back(ruris[4]), HeldBack::kNone);
}

// --- Names of fleets with invisible characters ---

constexpr std::string_view kZeroWidth = "no\xE2\x80\x8Brth";  // U+200B

TEST_F(GatewayTest, ANewFleetOfAnOddNameIsRefused) {
  server().fleet().odd_fleets().SetRead();
  EXPECT_EQ(ConnectOfFleet("rcan://a/1", kZeroWidth).end(),
            "UNAUTHENTICATED: client certificate: its O holds U+200B, which is invisible, and the "
            "store has no robot of that fleet");
  EXPECT_EQ(server().fleet().size(), 0U);
  EXPECT_EQ(server().probe().refused_identity_total.value(), 1);
  EXPECT_EQ(ConnectOfFleet("rcan://a/1", "north").end(), "");
}

TEST_F(GatewayTest, AFleetOfAnOddNameThatTheStoreHasGoesOn) {
  ASSERT_TRUE(
      server().fleet().AdmitNew({.ruri = "rcan://a/1", .fleet = std::string(kZeroWidth)}).ok());
  server().fleet().odd_fleets().SetRead();
  EXPECT_EQ(ConnectOfFleet("rcan://a/1", kZeroWidth).end(), "");
  EXPECT_EQ(ConnectOfFleet("rcan://a/2", kZeroWidth).end(), "") << "and takes new robots";
}

TEST_F(GatewayTest, UntilTheStoreWasReadAnOddNameWaits) {
  EXPECT_EQ(ConnectOfFleet("rcan://a/1", kZeroWidth).end(),
            "UNAVAILABLE: client certificate: its O holds an invisible character, and the "
            "server has not read yet whether the store has robots of that fleet");
}

// --- Name constraints ---

TEST_F(GatewayTest, SpeaksForNoHostThatItsAuthoritiesMayNotSignFor) {
  const testing::TestAuthority root;
  const testing::TestAuthority hall("hall", root, "permitted;URI:a");
  const auto authorities = identity::ReadCertificates({"hall", hall.certificate()});
  ASSERT_TRUE(authorities.ok());
  identity::PeerIdentity peer{.role = identity::Role::kGateway,
                              .fleet = "bench",
                              .gateway = {.subject = std::string(kSubject)}};
  peer.gateway.constraints.Add(*authorities->front());
  v1::RelayRequest frame = HelloFrame(SessionOf(1));
  frame.mutable_hello()->set_robot_ruri("rcan://a/1");
  BenchStream& within = server().OpenAs(peer);
  within.Send(frame);
  server().Commit();
  EXPECT_EQ(within.end(), "");
  frame.mutable_hello()->set_robot_ruri("rcan://b/1");
  BenchStream& beyond = server().OpenAs(peer);
  beyond.Send(frame);
  server().Commit();
  EXPECT_EQ(beyond.end(),
            "PERMISSION_DENIED: the certificate of gateway CN=hall,OU=gateway,O=bench may not "
            "speak for hello.robot_ruri rcan://b/1: an authority of its chain does not allow that "
            "host (name constraints)");
}

}  // namespace
}  // namespace uplink::session
