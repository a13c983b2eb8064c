// What operators decide of a robot, as its streams see it: blocked, disconnected, not added.
#include "server/fleet/robot_settings.h"
#include "tests/unit/server/session/session_test.h"

namespace uplink::session {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::SizeIs;

constexpr const char* kBlocked = "PERMISSION_DENIED: blocked";
constexpr const char* kDisconnected = "UNAVAILABLE: disconnected by an operator";
constexpr std::string_view kOther = "rcan://bench/2";

class OperatorTest : public SessionTest {
 protected:
  OperatorTest() {
    settings_.OnChange([this](std::span<const fleet::RobotSettings::Change> changes) {
      server().fleet().OnSettings(changes);
    });
    Rule({});
  }

  void Rule(const fleet::EntryRules& rules) { server().fleet().entry().Set(rules, settings_); }
  void StoreIsRead() {
    server().fleet().odd_fleets().SetRead();
    settings_.SetRead();
  }
  void Apply(storage::RobotSetting setting) {
    setting.ruri = kRobot;
    setting.version = ++version_;
    settings_.Apply({setting});
    server().DeliverWakes();
  }
  BenchStream& ConnectVia(std::string_view ruri, std::vector<std::string> ruris = {}) {
    BenchStream& stream = server().OpenAs(
        {.role = identity::Role::kGateway,
         .fleet = "bench",
         .gateway = {.subject = "CN=hall,OU=gateway,O=bench", .ruris = std::move(ruris)}});
    v1::RelayRequest frame = HelloFrame(SessionOf(1));
    frame.mutable_hello()->set_robot_ruri(std::string(ruri));
    stream.Send(frame);
    server().Commit();
    return stream;
  }

  fleet::RobotSettings settings_{10};

 private:
  storage::AccessVersion version_ = 0;
};

TEST_F(OperatorTest, AHelloOfABlockedRobotIsRefused) {
  Apply({.blocked = true, .blocked_why = "stolen"});
  EXPECT_EQ(server().Connect(SessionOf(1)).end(), kBlocked) << "the robot is not told why";
  EXPECT_EQ(server().fleet().size(), 0U);
  EXPECT_EQ(server().probe().refused_operator_total.value(), 1);
  Apply({});
  EXPECT_EQ(server().Connect(SessionOf(1)).end(), "");
}

TEST_F(OperatorTest, ABlockEndsTheStreamAndKeepsWhatItTook) {
  BenchStream& stream = server().Connect(SessionOf(1));
  stream.Send(BatchFrame({{1, Fault()}}));
  Apply({.blocked = true});
  EXPECT_EQ(stream.end(), kBlocked);
  server().Commit();
  EXPECT_THAT(Stored(1), ElementsAre(1));
  EXPECT_EQ(server().Connect(SessionOf(1)).end(), kBlocked);
}

TEST_F(OperatorTest, ABlockEndsOneStreamOfAGateway) {
  BenchStream& blocked = ConnectVia(kRobot);
  BenchStream& other = ConnectVia(kOther);
  Apply({.blocked = true});
  EXPECT_EQ(blocked.end(), kBlocked);
  EXPECT_EQ(other.end(), "");
  EXPECT_EQ(ConnectVia(kRobot).end(), kBlocked);
}

TEST_F(OperatorTest, AStreamThatWaitsForItsTurnIsBlockedToo) {
  for (std::size_t i = 0; i < robot::kStreamsPerMinuteMax; ++i) {
    server().Connect(SessionOf(1)).Break();
  }
  BenchStream& waits = server().Connect(SessionOf(1));
  EXPECT_EQ(server().probe().waiting.value(), 1);
  Apply({.blocked = true});
  server().Pass(std::chrono::minutes(2));
  EXPECT_EQ(waits.end(), kBlocked);
}

TEST_F(OperatorTest, ADisconnectEndsTheStreamOnceAndTheRobotMayComeAgain) {
  BenchStream& stream = server().Connect(SessionOf(1));
  Apply({.disconnect_at = clock_.System()});
  EXPECT_EQ(stream.end(), kDisconnected);
  BenchStream& again = server().Connect(SessionOf(1));
  Apply({.note = "in the hall", .disconnect_at = clock_.System()});
  EXPECT_EQ(again.end(), "");
}

TEST_F(OperatorTest, AnAskToDisconnectCountsWhateverTheClockOfItsServerSays) {
  for (const auto ahead : {std::chrono::hours(-1), std::chrono::hours(1)}) {
    BenchStream& stream = server().Connect(SessionOf(1));
    Apply({.disconnect_at = clock_.System() + ahead});
    EXPECT_EQ(stream.end(), kDisconnected) << ahead.count();
  }
}

TEST_F(OperatorTest, WhereRegistrationIsClosedANewRobotIsRefusedAndBecomesACandidate) {
  Rule({.only_registered = true});
  StoreIsRead();
  EXPECT_THAT(server().Connect(SessionOf(1)).end(),
              HasSubstr("PERMISSION_DENIED: rcan://bench/1 is not registered"));
  EXPECT_THAT(server().fleet().entry().candidates().All(), SizeIs(1));
  Apply({.registered = true});
  EXPECT_EQ(server().Connect(SessionOf(1)).end(), "");
}

TEST_F(OperatorTest, ARobotThatCameBeforeTheStoreWasReadIsEndedOnceItIsUnlessItWasAdded) {
  Rule({.only_registered = true});
  BenchStream& stream = server().Connect(SessionOf(1));
  server().Pass(kWelcomeWait);
  stream.Send(BatchFrame({{1, Fault()}, {2, Motion()}}));
  server().Commit();
  EXPECT_EQ(stream.end(), "");
  EXPECT_THAT(Stored(1), ::testing::IsEmpty()) << "it may be no robot of ours";
  StoreIsRead();
  static_cast<void>(server().fleet().Sweep(std::chrono::hours(1)));
  server().Commit();
  EXPECT_THAT(stream.end(), HasSubstr("PERMISSION_DENIED: rcan://bench/1 is not registered"));
  EXPECT_THAT(Stored(1), ::testing::IsEmpty());
  EXPECT_THAT(server().store().Robots(10).value(), ::testing::IsEmpty()) << "a restart forgets it";
  EXPECT_THAT(server().fleet().entry().candidates().All(), SizeIs(1));
  EXPECT_EQ(server().probe().refused_operator_total.value(), 1);
  EXPECT_THAT(server().Connect(SessionOf(1)).end(), HasSubstr("is not registered"));
  Apply({.registered = true});
  BenchStream& again = server().Connect(SessionOf(1));
  server().Commit();
  again.Send(BatchFrame({{1, Fault()}}));
  server().Commit();
  EXPECT_EQ(again.end(), "");
  EXPECT_THAT(Stored(1), ElementsAre(1));
}

TEST_F(OperatorTest, AKnownRobotThatCameBeforeTheStoreWasReadStreamsOn) {
  Rule({.only_registered = true});
  BenchStream& stream = server().Connect(SessionOf(1));
  server().Pass(kWelcomeWait);
  stream.Send(BatchFrame({{1, Fault()}}));
  ASSERT_TRUE(server().fleet().AdmitNew({.ruri = std::string(kRobot), .fleet = "bench"}).ok());
  StoreIsRead();
  static_cast<void>(server().fleet().Sweep(std::chrono::hours(1)));
  server().Commit();
  EXPECT_EQ(stream.end(), "");
  EXPECT_THAT(Stored(1), ElementsAre(1));
}

TEST_F(OperatorTest, ABlockThatIsReadLateEndsAStreamThatCameBefore) {
  BenchStream& stream = server().Connect(SessionOf(1));
  settings_.Replace({{.ruri = std::string(kRobot), .blocked = true, .version = 7}});
  server().DeliverWakes();
  EXPECT_EQ(stream.end(), kBlocked);
}

TEST_F(OperatorTest, WhereGatewaysMustNameTheirRobotsOneWithoutNamesIsRefused) {
  Rule({.only_named = true});
  EXPECT_THAT(ConnectVia(kRobot).end(), HasSubstr("names no robots"));
  EXPECT_EQ(ConnectVia(kRobot, {std::string(kRobot)}).end(), "");
}

TEST_F(OperatorTest, WhereFleetsStayACertificateOfAnotherFleetIsRefused) {
  Rule({.fleets_stay = true});
  EXPECT_EQ(server().Connect(SessionOf(1)).end(), "");
  BenchStream& other = server().OpenAs(
      {.role = identity::Role::kRobot, .fleet = "other", .ruri = std::string(kRobot)});
  other.Send(HelloFrame(SessionOf(1)));
  EXPECT_THAT(other.end(), HasSubstr("is of another fleet than the certificate, other"));
}

TEST_F(OperatorTest, TheStoreKeepsARobotWhoseFleetIsOutsideOfTheAuthority) {
  EXPECT_EQ(server().Connect(SessionOf(1)).end(), "");
  server().Commit();
  Start();
  BenchStream& other = server().OpenAs(
      {.role = identity::Role::kRobot,
       .fleet = "other",
       .ruri = std::string(kRobot),
       .bounds = std::make_shared<const identity::FleetBounds>(identity::FleetBounds{
           .authority = "guests", .fleets = identity::Scope::Of({"other"})})});
  other.Send(HelloFrame(SessionOf(1)));
  server().Commit();
  EXPECT_THAT(other.end(), HasSubstr("its authority guests may not move this robot"));
}

TEST_F(OperatorTest, WhereFleetsStayTheStoreKeepsARobotThatMemoryForgot) {
  EXPECT_EQ(server().Connect(SessionOf(1)).end(), "");
  server().Commit();
  Start();
  Rule({.fleets_stay = true});
  BenchStream& other = server().OpenAs(
      {.role = identity::Role::kRobot, .fleet = "other", .ruri = std::string(kRobot)});
  other.Send(HelloFrame(SessionOf(1)));
  server().Commit();
  EXPECT_THAT(other.end(), HasSubstr("identity.fleet_moves"));
}

}  // namespace
}  // namespace uplink::session
