// Crowds at the door: connections that show nothing, or that leave at once.
#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "tests/component/front/hostile.h"
#include "tests/support/tcp_crowd.h"

namespace uplink::testing {
namespace {

using transport::TurnedAway;

/// So few that a test can take every place: 128 handshakes, and as many that wait.
constexpr std::size_t kDescriptors = 1024;
/// More than have a place and may wait.
constexpr std::size_t kCrowd = 300;
/// How long an honest robot may have to wait before the door.
constexpr std::chrono::milliseconds kGetsInWithin{10'000};
constexpr std::size_t kHandshakes = 200;

/// A world that believes it has few descriptors.
class HostileDoor : public ::testing::Test {
 protected:
  void SetUp() override { ASSERT_TRUE(victim_.GoesOn()); }
  void TearDown() override {
    EXPECT_TRUE(victim_.GoesOn());
    EXPECT_TRUE(Eventually([this] { return world_->server().streams() == 1; }));
    EXPECT_TRUE(victim_.Finish());
    EXPECT_EQ(world_->database.Log(victim_.ruri(), Victim::session()).stored.size(),
              victim_.acked());
  }

  static std::unique_ptr<RelayWorld> MakeWorld() {
    const DescriptorLimit limit(kDescriptors);
    return std::make_unique<RelayWorld>();
  }
  /// Connections that say this and no more.
  TcpCrowd Gather(std::size_t count, const std::vector<std::string>& sources,
                  const std::string& word) {
    TcpCrowd crowd(world_->server().port(), sources, word);
    crowd.Grow(count);
    return crowd;
  }
  /// A robot from an address that has not streamed gets in, though it is a stranger.
  void ExpectStrangerGetsIn(int number) {
    const SteadyTime begun = world_->clock.Steady();
    RawHttp2 robot(ClientOf(*world_, RobotKeys(*world_, number), "127.0.0.200"));
    ASSERT_TRUE(robot.Begin());
    robot.Send(OpenRelay(1) + http2::Data(1, HelloMessage(1) + FaultsMessage(1, 1)));
    EXPECT_TRUE(
        robot.ReadUntil([&] { return LastAck(robot.At(1)).through_seq() == 1; }, kGetsInWithin));
    EXPECT_LT(world_->clock.Steady() - begun, kGetsInWithin);
  }

  std::unique_ptr<RelayWorld> world_ = MakeWorld();
  Victim victim_{*world_, 1};
};

struct Crowd {
  const char* name;
  std::vector<std::string> sources;
  std::string word;
};

class HostileCrowd : public HostileDoor, public ::testing::WithParamInterface<Crowd> {};

TEST_P(HostileCrowd, KeepsNobodyOut) {
  const TcpCrowd crowd = Gather(kCrowd, GetParam().sources, GetParam().word);
  EXPECT_TRUE(Eventually([&] { return TurnedAwayFor(*world_, TurnedAway::kCrowded) > 0; }));
  EXPECT_TRUE(victim_.GoesOn());
  ExpectStrangerGetsIn(20);
  EXPECT_TRUE(ServesNewRobot(*world_, 21, kGetsInWithin));
}

INSTANTIATE_TEST_SUITE_P(
    All, HostileCrowd,
    ::testing::Values(Crowd{"HalfOpenHandshakesOfOneAddress", {"127.0.0.66"}, TlsClientHello()},
                      Crowd{"HalfOpenHandshakesOfFiftyAddresses", LoopbackSources(2, 50),
                            TlsClientHello()},
                      Crowd{"SilentConnections", {"127.0.0.66"}, ""}),
    [](const auto& instance) { return instance.param.name; });

TEST_F(HostileDoor, HalfOpenHandshakesFromTheVictimsAddressKeepNobodyOut) {
  const TcpCrowd crowd = Gather(kCrowd, {"127.0.0.1"}, TlsClientHello());
  EXPECT_TRUE(victim_.GoesOn());
  ExpectStrangerGetsIn(20);
}

TEST_F(HostileDoor, GarbageInPlaceOfAHandshakeIsTurnedAway) {
  const TcpCrowd crowd = Gather(kCrowd, {"127.0.0.66"}, std::string(2000, '\x07'));
  for (const auto& one : crowd.members()) EXPECT_TRUE(one->WaitForEnd(kPatience));
  EXPECT_TRUE(Eventually([&] { return TurnedAwayFor(*world_, TurnedAway::kNoTls) > 0; }));
  EXPECT_TRUE(ServesNewRobot(*world_, 21, kGetsInWithin));
}

TEST_F(HostileDoor, HandshakesThatLeaveAtOnceCostNobodyHisPlace) {
  const KeyPair keys = RobotKeys(*world_, 666);
  for (std::size_t i = 0; i < kHandshakes; ++i) {
    const RawHttp2 passer_by(ClientOf(*world_, keys, "127.0.0.66"));
    EXPECT_TRUE(passer_by.handshaken());
  }
  EXPECT_TRUE(victim_.GoesOn());
  EXPECT_TRUE(ServesNewRobot(*world_, 21, kGetsInWithin));
  EXPECT_TRUE(Eventually([&] { return world_->relay_probe.handshakes_under_way.value() == 0; }));
  EXPECT_TRUE(Eventually([&] { return TurnedAwayFor(*world_, TurnedAway::kNoStream) > 100; }));
}

TEST_F(HostileDoor, WhoLeavesInTheMiddleOfAHandshakeIsNamed) {
  { const TcpCrowd crowd = Gather(kHandshakes, {"127.0.0.66"}, TlsClientHello()); }
  EXPECT_TRUE(Eventually([&] { return TurnedAwayFor(*world_, TurnedAway::kHandshakeError) > 0; }));
  EXPECT_TRUE(victim_.GoesOn());
}

TEST_F(HostileDoor, WhoLeavesBeforeItsFirstMessageIsWholeIsNamed) {
  constexpr std::int64_t kEach = 20;
  const auto errors = [&] { return TurnedAwayFor(*world_, TurnedAway::kHandshakeError); };
  const std::string hello = TlsClientHello();
  // A part of a record's header, a header alone, and all but a byte.
  for (const std::size_t size : {std::size_t{1}, std::size_t{5}, hello.size() - 1}) {
    const std::int64_t before = errors();
    { const TcpCrowd crowd = Gather(kEach, {"127.0.0.66"}, hello.substr(0, size)); }
    EXPECT_TRUE(Eventually([&] { return errors() == before + kEach; })) << size << ' ' << errors();
  }
  const std::int64_t before = errors();
  { const TcpCrowd crowd = Gather(kEach, {"127.0.0.66"}, ""); }
  ExpectStrangerGetsIn(20);
  EXPECT_TRUE(Eventually([&] { return world_->relay_probe.handshakes_under_way.value() == 0; }));
  EXPECT_EQ(errors(), before) << "who says nothing looks whether we answer";
}

TEST_F(HostileDoor, HandshakesWithoutACertificateCostNobodyHisPlace) {
  for (std::size_t i = 0; i < kHandshakes; ++i) {
    const RawHttp2 stranger(ClientOf(*world_, {}, "127.0.0.66"));
  }
  EXPECT_TRUE(victim_.GoesOn());
  ExpectStrangerGetsIn(20);
  EXPECT_TRUE(Eventually([&] { return TurnedAwayFor(*world_, TurnedAway::kNoCertificate) > 100; }));
}

// --- One robot's own certificate ---

std::unique_ptr<RawHttp2> Begun(const RelayWorld& world, const KeyPair& keys) {
  auto client = std::make_unique<RawHttp2>(ClientOf(world, keys));
  EXPECT_TRUE(client->Begin());
  return client;
}

TEST_F(HostileDoor, TheFifthConnectionOfACertificateEvictsTheOldestWithoutAStream) {
  const KeyPair keys = RobotKeys(*world_, 666);
  std::vector<std::unique_ptr<RawHttp2>> clients;
  clients.reserve(4);
  for (int i = 0; i < 4; ++i) clients.push_back(Begun(*world_, keys));
  clients[0]->Send(OpenRelay(1));
  ASSERT_TRUE(Eventually([&] { return world_->server().streams() == 2; }));
  const auto fifth = Begun(*world_, keys);
  EXPECT_TRUE(clients[1]->ReadUntilEnd());
  EXPECT_EQ(clients[1]->goaway_code(), http2::kEnhanceYourCalm);
  EXPECT_EQ(clients[1]->goaway_text(), "too many connections of this certificate");
  for (RawHttp2* stays : {clients[0].get(), clients[2].get(), clients[3].get(), fifth.get()}) {
    EXPECT_TRUE(stays->Sync());
  }
  EXPECT_EQ(TurnedAwayFor(*world_, TurnedAway::kKey), 1);
}

TEST_F(HostileDoor, ManyConnectionsOfOneCertificateEvictNobodyElsesAndKeepNoPlace) {
  constexpr int kMany = 100;
  // The victim's and four; those that are on their way out come on top.
  constexpr std::int64_t kPlaces = 1 + 4 + 8;
  const KeyPair keys = RobotKeys(*world_, 666);
  std::int64_t most = 0;
  std::vector<std::unique_ptr<RawHttp2>> clients;
  for (int i = 0; i < kMany; ++i) {
    clients.push_back(Begun(*world_, keys));
    most = std::max(most, world_->relay_probe.connections.value());
  }
  EXPECT_LE(most, kPlaces);
  EXPECT_TRUE(Eventually([&] { return TurnedAwayFor(*world_, TurnedAway::kKey) == kMany - 4; }));
  EXPECT_TRUE(Eventually([&] { return world_->relay_probe.connections.value() == 5; }));
  EXPECT_TRUE(victim_.GoesOn());
  EXPECT_TRUE(clients.back()->Sync());
  EXPECT_TRUE(ServesNewRobot(*world_, 21, kGetsInWithin));
}

}  // namespace
}  // namespace uplink::testing
