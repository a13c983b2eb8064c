// Gateways: one connection, a stream for each robot, over real TLS.
#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "schema/encode.h"
#include "server/cyberwave/twins.h"
#include "server/fleet/live_budget.h"
#include "tests/component/front/shared_lines.h"
#include "tests/support/fault_proxy.h"
#include "tests/support/relay_world.h"

namespace uplink::testing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr const char* kFleet = "north";
/// What the test's authority makes of GatewaySpec.
constexpr const char* kSubject = "CN=hall,OU=gateway,O=north";

CertificateSpec GatewaySpec(std::vector<std::string> ruris = {}) {
  CertificateSpec spec;
  spec.common_names = {"hall"};
  spec.organizations = {kFleet};
  spec.units = {"gateway"};
  spec.uris = std::move(ruris);
  return spec;
}

/// A robot's stream through a gateway's channel.
class Relayed final {
 public:
  Relayed(const std::shared_ptr<grpc::Channel>& channel, int robot, int session = 1)
      : agent_(channel), ruri_(RuriOf(robot)) {
    v1::RelayRequest hello = HelloFrame(SessionOf(static_cast<std::uint8_t>(session)));
    hello.mutable_hello()->set_robot_ruri(ruri_);
    agent_.Send(hello);
  }
  /// The robot that Welcome names; empty if none came.
  [[nodiscard]] std::string Welcomed() {
    const auto frame = agent_.Read();
    return frame && frame->has_welcome() ? frame->welcome().robot_ruri() : std::string();
  }
  [[nodiscard]] TestAgent& agent() { return agent_; }
  [[nodiscard]] const std::string& ruri() const { return ruri_; }

 private:
  TestAgent agent_;
  const std::string ruri_;
};

std::string GatewayOf(const RelayWorld& world, int robot) {
  const fleet::RobotPtr known = world.fleet.Find(RuriOf(robot));
  if (known == nullptr) return "unknown";
  const robot::SessionView view = known->sessions.View();
  return view.connected ? view.gateway : "";
}

TEST(Gateway, RelaysForManyRobotsOnOneConnection) {
  RelayWorld world;
  const auto channel = world.Channel(world.authority.Issue(GatewaySpec()));
  std::vector<std::unique_ptr<Relayed>> robots;
  for (int i = 1; i <= 5; ++i) {
    Relayed& robot = *robots.emplace_back(std::make_unique<Relayed>(channel, i));
    ASSERT_EQ(robot.Welcomed(), robot.ruri());
    robot.agent().Send(BatchFrame({{1, FaultPayload("a")}}));
    EXPECT_TRUE(robot.agent().ReadThrough(1));
    EXPECT_EQ(GatewayOf(world, i), kSubject);
    EXPECT_EQ(world.fleet.Find(robot.ruri())->id()->fleet, kFleet);
  }
  EXPECT_EQ(world.relay_probe.gateway_streams.value(), 5);
  robots.front()->agent().HalfClose();
  EXPECT_TRUE(robots.front()->agent().End().ok());
  EXPECT_TRUE(Eventually([&] { return world.relay_probe.gateway_streams.value() == 4; }));
  EXPECT_EQ(GatewayOf(world, 1), "");
  EXPECT_TRUE(world.Settles());
}

TEST(Gateway, SpeaksForNoTwinOfItsFleet) {
  RelayWorld world;
  TestAgent agent(world.Channel(world.authority.Issue(GatewaySpec())));
  v1::RelayRequest hello = HelloFrame(SessionOf(1));
  hello.mutable_hello()->set_robot_ruri(
      "rcan://local.rcan/cyberwave/twin/3f2504e0-4f89-11d3-9a0c-0305e82c3301");
  agent.Send(hello);
  const grpc::Status status = agent.End();
  EXPECT_EQ(status.error_code(), grpc::StatusCode::PERMISSION_DENIED);
  EXPECT_THAT(status.error_message(),
              ::testing::HasSubstr("is a twin's, and twins are heard through their broker alone"));
  EXPECT_EQ(world.session_probe.refused_identity_total.value(), 1);
  EXPECT_EQ(world.fleet.size(), 0U);
}

TEST(Gateway, SpeaksForThoseThatItsCertificateNames) {
  RelayWorld world;
  const auto channel = world.Channel(world.authority.Issue(GatewaySpec({RuriOf(1), RuriOf(2)})));
  Relayed granted(channel, 2);
  EXPECT_EQ(granted.Welcomed(), RuriOf(2));
  Relayed denied(channel, 3);
  const grpc::Status status = denied.agent().End();
  EXPECT_EQ(status.error_code(), grpc::StatusCode::PERMISSION_DENIED);
  EXPECT_THAT(status.error_message(), HasSubstr(RuriOf(3)));
  EXPECT_EQ(world.fleet.Find(RuriOf(3)), nullptr);
  granted.agent().Send(BatchFrame({{1, FaultPayload("a")}}));
  EXPECT_TRUE(granted.agent().ReadThrough(1)) << "its other streams go on";
}

TEST(Gateway, DoesNotReachIntoAnotherFleet) {
  RelayWorld world;
  TestAgent own(world.Channel(world.authority.Issue(RobotSpec(RuriOf(1), "south"))));
  ASSERT_TRUE(own.Connect(SessionOf(1)));
  Relayed denied(world.Channel(world.authority.Issue(GatewaySpec())), 1);
  const grpc::Status status = denied.agent().End();
  EXPECT_EQ(status.error_code(), grpc::StatusCode::PERMISSION_DENIED);
  EXPECT_THAT(status.error_message(),
              AllOf(HasSubstr(RuriOf(1)), HasSubstr("the robot is of another fleet")));
  EXPECT_EQ(world.fleet.Find(RuriOf(1))->id()->fleet, "south");
  own.Send(BatchFrame({{1, FaultPayload("a")}}));
  EXPECT_TRUE(own.ReadThrough(1)) << "its stream was not touched";
}

/// The store knows the robot, and the server does not yet.
void NoteInStore(RelayWorld& world, const model::RobotId& robot) {
  FakeStore before(world.database, storage::ProcessId{2});
  const storage::OpenRequest known{.robot = std::make_shared<const model::RobotId>(robot),
                                   .session = SessionOf(1)};
  ASSERT_TRUE(before.OpenStreams({&known, 1}).ok());
}

TEST(Gateway, DoesNotReachIntoAnotherFleetThatTheStoreAloneKnows) {
  RelayWorld world;
  NoteInStore(world, {RuriOf(1), "south"});
  ASSERT_EQ(world.fleet.Find(RuriOf(1)), nullptr) << "as after a restart";
  const auto channel = world.Channel(world.authority.Issue(GatewaySpec()));
  Relayed neighbour(channel, 2);
  ASSERT_EQ(neighbour.Welcomed(), RuriOf(2));
  Relayed denied(channel, 1);
  EXPECT_EQ(denied.Welcomed(), "");
  const grpc::Status status = denied.agent().End();
  EXPECT_EQ(status.error_code(), grpc::StatusCode::PERMISSION_DENIED);
  EXPECT_THAT(status.error_message(),
              AllOf(HasSubstr(RuriOf(1)), HasSubstr("the robot is of another fleet")));
  EXPECT_EQ(world.fleet.Find(RuriOf(1))->id()->fleet, "south");
  TestAgent own(world.Channel(world.authority.Issue(RobotSpec(RuriOf(1), "south"))));
  ASSERT_TRUE(own.Connect(SessionOf(1)));
  for (TestAgent* agent : {&neighbour.agent(), &own}) {
    agent->Send(BatchFrame({{1, FaultPayload("a")}}));
    EXPECT_TRUE(agent->ReadThrough(1));
  }
  EXPECT_TRUE(world.Settles());
}

TEST(Gateway, EndsWhenTheStoreComesBackAndKnowsAnotherFleet) {
  RelayWorld world;
  NoteInStore(world, {RuriOf(1), "south"});
  world.store.Block();
  Relayed through(world.Channel(world.authority.Issue(GatewaySpec())), 1);
  ASSERT_EQ(through.Welcomed(), RuriOf(1)) << "the store is away, so the fleet is not known yet";
  through.agent().Send(BatchFrame({{1, FaultPayload("a")}}));
  ASSERT_TRUE(Eventually([&] { return world.Counts().in_flight == 1; }));
  world.store.Release();
  const grpc::Status status = through.agent().End();
  EXPECT_EQ(status.error_code(), grpc::StatusCode::PERMISSION_DENIED);
  EXPECT_THAT(status.error_message(), HasSubstr("the robot is of another fleet"));
  EXPECT_TRUE(world.Settles());
  EXPECT_EQ(world.Counts().superseded, 1U);
  EXPECT_TRUE(world.database.Log(RuriOf(1), SessionOf(1)).stored.empty());
  EXPECT_EQ(world.fleet.Find(RuriOf(1))->id()->fleet, "south");
}

TEST(Gateway, CompetesWithTheRobotsOwnStream) {
  RelayWorld world;
  const auto channel = world.Channel(world.authority.Issue(GatewaySpec()));
  TestAgent own(world.Channel(world.authority.Issue(RobotSpec(RuriOf(1), kFleet))));
  ASSERT_TRUE(own.Connect(SessionOf(1)));
  Relayed through(channel, 1);
  ASSERT_EQ(through.Welcomed(), RuriOf(1));
  EXPECT_EQ(own.End().error_code(), grpc::StatusCode::ABORTED);
  EXPECT_EQ(GatewayOf(world, 1), kSubject);
  TestAgent again(world.Channel(world.authority.Issue(RobotSpec(RuriOf(1), kFleet))));
  ASSERT_TRUE(again.Connect(SessionOf(1)));
  EXPECT_EQ(through.agent().End().error_code(), grpc::StatusCode::ABORTED);
  EXPECT_EQ(GatewayOf(world, 1), "");
}

TEST(Gateway, ABrokenConnectionEndsItsStreamsAndNothingElse) {
  RelayWorld world;
  FaultProxy proxy(world.port());
  const KeyPair keys = world.authority.Issue(GatewaySpec());
  const auto cut = MakeChannel(
      {.port = proxy.port(), .server_ca = world.authority.certificate(), .identity = keys});
  Relayed first(cut, 1);
  Relayed second(cut, 2);
  Relayed elsewhere(world.Channel(keys), 3);
  TestAgent own(world.Channel(RuriOf(4)));
  ASSERT_NE(first.Welcomed(), "");
  ASSERT_NE(second.Welcomed(), "");
  ASSERT_NE(elsewhere.Welcomed(), "");
  ASSERT_TRUE(own.Connect(SessionOf(1)));
  proxy.Set(ProxyMode::kRefuse);
  EXPECT_EQ(first.agent().End().error_code(), grpc::StatusCode::UNAVAILABLE);
  EXPECT_EQ(second.agent().End().error_code(), grpc::StatusCode::UNAVAILABLE);
  EXPECT_TRUE(Eventually([&] { return world.server().streams() == 2; }));
  EXPECT_FALSE(world.fleet.Find(RuriOf(1))->HasStream());
  for (TestAgent* agent : {&elsewhere.agent(), &own}) {
    agent->Send(BatchFrame({{1, FaultPayload("a")}}));
    EXPECT_TRUE(agent->ReadThrough(1));
  }
}

TEST(Gateway, HasNoMoreThanItsShareOfTheStreams) {
  RelayWorld world({.session = {}, .journal = {}, .streams_max = 4});
  const KeyPair keys = world.authority.Issue(GatewaySpec());
  std::vector<std::unique_ptr<Relayed>> robots;
  for (int i = 1; i <= 3; ++i) {
    // Over several connections: they are counted together.
    robots.push_back(std::make_unique<Relayed>(world.Channel(keys), i));
    ASSERT_NE(robots.back()->Welcomed(), "");
  }
  {
    Relayed fourth(world.Channel(keys), 4);
    const grpc::Status status = fourth.agent().End();
    EXPECT_EQ(status.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
    EXPECT_THAT(status.error_message(),
                HasSubstr(std::string("no more streams of gateway ") + kSubject));
  }
  EXPECT_EQ(world.relay_probe.refused_gateway_total.value(), 1);
  TestAgent own(world.Channel(RuriOf(5)));
  EXPECT_TRUE(own.Connect(SessionOf(1)));
}

TEST(Gateway, BringsInNoMoreThanItsShareOfTheRobots) {
  RelayWorld world({.session = {}, .journal = {}, .robots_max = 4});
  const auto channel = world.Channel(world.authority.Issue(GatewaySpec()));
  for (int i = 1; i <= 3; ++i) {
    Relayed robot(channel, i);
    ASSERT_NE(robot.Welcomed(), "");
  }
  Relayed fourth(channel, 4);
  const grpc::Status status = fourth.agent().End();
  EXPECT_EQ(status.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_THAT(status.error_message(), HasSubstr("has brought in 3 robots"));
  EXPECT_EQ(world.session_probe.refused_gateway_total.value(), 1);
  TestAgent own(world.Channel(RuriOf(5)));
  EXPECT_TRUE(own.Connect(SessionOf(1)));
}

/// Ten readings with texts of control characters; each character is kept as three bytes.
std::string ExtrasPayload(int first_key) {
  model::TelemetryExtras extras;
  for (int i = first_key; i < first_key + 10; ++i) {
    extras.kv.push_back(
        {.key = std::to_string(i), .value = std::string(4'000, '\x01'), .unix_time_ms = {}});
  }
  return schema::Encode(extras);
}

TEST(Gateway, WhoseRobotsFillTheMemoryLosesTheirLiveStateAndNobodyElse) {
  constexpr std::size_t kBudget = 1'000'000;
  SharedLines::Lines lines;
  SystemClock clock;
  const log::Logger logger{std::make_unique<SharedLines>(lines), clock, log::Format::kText,
                           log::Level::kDebug};
  RelayWorld world;
  cyberwave::Twins twins(1, world.fleet.live_total());
  fleet::LiveBudget budget({world.clock, world.fleet, twins, logger, kBudget});
  TestAgent honest(world.Channel(world.authority.Issue(RobotSpec(RuriOf(1), "south"))));
  ASSERT_TRUE(honest.Connect(SessionOf(1)));
  honest.Send(BatchFrame({{1, ExtrasPayload(0)}}));
  ASSERT_TRUE(honest.ReadThrough(1));
  const std::size_t held = world.fleet.Find(RuriOf(1))->state.live_bytes();
  EXPECT_GT(held, 120'000U);
  const auto channel = world.Channel(world.authority.Issue(GatewaySpec()));
  for (int i = 2; i < 12; ++i) {
    Relayed robot(channel, i);
    ASSERT_EQ(robot.Welcomed(), robot.ruri());
    robot.agent().Send(BatchFrame({{1, ExtrasPayload(0)}, {2, ExtrasPayload(10)}}));
    ASSERT_TRUE(robot.agent().ReadThrough(2));
    EXPECT_LE(budget.bytes(), kBudget);
  }
  EXPECT_GT(budget.parts_dropped(), 4U);
  EXPECT_EQ(world.fleet.Find(RuriOf(1))->state.live_bytes(), held);
  budget.Round();
  ASSERT_THAT(lines.All(), ::testing::SizeIs(1));
  EXPECT_THAT(lines.All().front(), AllOf(HasSubstr("live_state_dropped"), HasSubstr(kSubject)));
  EXPECT_TRUE(world.Settles()) << "what was dropped was applied";
}

}  // namespace
}  // namespace uplink::testing
