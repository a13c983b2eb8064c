// Behind a load balancer: who counts as the source, and who makes no noise.
#include <filesystem>
#include <iterator>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/front/door/door.h"
#include "server/front/door/origin_reader.h"
#include "tests/component/front/front_world.h"
#include "tests/component/front/shared_lines.h"
#include "tests/support/proxy_headers.h"
#include "tests/support/tcp_crowd.h"

namespace uplink::testing {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using transport::TurnedAway;

constexpr const char* kLoadBalancer = "127.0.0.9";
constexpr const char* kSource = "203.0.113.7";
/// So few that a test can take every place: 128 handshakes, and 64 that wait.
constexpr std::size_t kDescriptors = 1024;
constexpr std::size_t kCrowd = 300;
constexpr std::int64_t kPlaces = 128;
constexpr int kRobots = 5;
constexpr std::chrono::milliseconds kGetsInWithin{10'000};

std::size_t OpenDescriptors() {
  const std::filesystem::directory_iterator all("/proc/self/fd");
  return static_cast<std::size_t>(std::distance(begin(all), end(all)));
}

class LoadBalancer : public ::testing::Test {
 protected:
  LoadBalancer() { Make(); }

  void Make() {
    RelayWorld::Options options;
    options.proxy_protocol_from = {*config::Network::Parse(kLoadBalancer)};
    options.logger = &logger_;
    world_ = std::make_unique<RelayWorld>(options);
  }
  /// What a robot looks like behind the load balancer that says this of it.
  [[nodiscard]] RawHttp2::Options Behind(const std::string& header, const KeyPair& keys) const {
    RawHttp2::Options options = ClientOf(*world_, keys, kLoadBalancer);
    options.before_tls = header;
    return options;
  }
  [[nodiscard]] RawHttp2::Options Behind(const std::string& header, int robot = 1) const {
    return Behind(header, RobotKeys(*world_, robot));
  }
  /// The robot has a message stored.
  static bool Streams(RawHttp2& robot) {
    if (!robot.Begin()) return false;
    robot.Send(OpenRelay(1) + http2::Data(1, HelloMessage(1) + FaultsMessage(1, 1)));
    return robot.ReadUntil([&] { return LastAck(robot.At(1)).through_seq() == 1; }, kGetsInWithin);
  }
  [[nodiscard]] std::int64_t TurnedAwayForAll() const {
    std::int64_t all = 0;
    for (const auto& cell : world_->relay_probe.turned_away_total) all += cell.value();
    return all;
  }
  [[nodiscard]] std::vector<std::string> Lines() { return lines_.All(); }
  [[nodiscard]] std::int64_t waiting() const {
    return world_->relay_probe.proxy_headers_waiting.value();
  }
  /// No connection waits before the door or is in it any more.
  [[nodiscard]] bool IsQuiet() const {
    return Eventually([this] {
      return waiting() == 0 && world_->relay_probe.handshakes_under_way.value() == 0 &&
             world_->relay_probe.connections.value() == 0;
    });
  }
  std::uint16_t port() { return world_->server().port(); }

  SharedLines::Lines lines_;
  SystemClock clock_;
  log::Logger logger_{std::make_unique<SharedLines>(lines_), clock_, log::Format::kText,
                      log::Level::kInfo};
  std::unique_ptr<RelayWorld> world_;
};

// --- The real source ---

TEST_F(LoadBalancer, HeaderAndClientHelloInOnePacketAreServed) {
  for (const std::string& header :
       {ProxyHeaderFor(kSource), ProxyHeaderFor("2001:db8::7"),
        ProxyHeaderFor(kSource, 1, ProxyTlv(1, "h2") + ProxyTlv(0x20, std::string(400, 'x'))),
        ProxyHeaderBytes(kProxyRelayed, kProxyUnspec, {}), LocalProxyHeader()}) {
    Make();
    RawHttp2 robot(Behind(header));
    EXPECT_TRUE(Streams(robot));
  }
}

TEST_F(LoadBalancer, AHeaderMayBeSplitAtEachByte) {
  const std::string header = ProxyHeaderFor(kSource, 1, ProxyTlv(1, "h2"));
  for (std::size_t at = 1; at < header.size(); ++at) {
    RawHttp2::Options options = Behind(header.substr(at));
    options.at_first = [&](RawTcp& connection) {
      EXPECT_EQ(connection.SendSome(header.substr(0, at)), at);
      EXPECT_TRUE(Eventually([&] { return waiting() == 1; }));
    };
    const RawHttp2 robot(options);
    EXPECT_TRUE(robot.handshaken()) << at;
  }
  EXPECT_EQ(TurnedAwayFor(*world_, TurnedAway::kProxyHeader), 0);
  EXPECT_EQ(TurnedAwayFor(*world_, TurnedAway::kNoTls), 0);
}

TEST_F(LoadBalancer, LinesNameWhomTheHeaderNames) {
  {
    RawHttp2 stranger(Behind(ProxyHeaderFor(kSource, 5555), KeyPair{}));
    EXPECT_TRUE(stranger.ReadUntilEnd());
    RawHttp2 another(Behind(ProxyHeaderFor("2001:db8:1:2::7", 5556), KeyPair{}));
    EXPECT_TRUE(another.ReadUntilEnd());
  }
  EXPECT_TRUE(Eventually([&] { return TurnedAwayFor(*world_, TurnedAway::kNoCertificate) == 2; }));
  EXPECT_THAT(Lines(), Contains(AllOf(HasSubstr("source=203.0.113.7 peer=203.0.113.7:5555"),
                                      HasSubstr("why=no_certificate"))));
  EXPECT_THAT(Lines(), Contains(HasSubstr("source=2001:db8:1:2::/64")));
}

TEST_F(LoadBalancer, AnotherSourceGetsInBesideACrowdBehindTheSameLoadBalancer) {
  {
    const DescriptorLimit limit(kDescriptors);
    Make();
  }
  TcpCrowd crowd(port(), {kLoadBalancer}, ProxyHeaderFor("203.0.113.66") + TlsClientHello());
  crowd.Grow(kCrowd);
  const auto gave_way = [this] { return TurnedAwayFor(*world_, TurnedAway::kGaveWay); };
  // Each robot finds every place taken, and others that wait. On a slow machine a handshake of the
  // crowd may end by its own time just then, and leave a place.
  for (int robot = 1; robot <= kRobots && gave_way() == 0; ++robot) {
    ASSERT_TRUE(Eventually([&] {
      static_cast<void>(crowd.Replace());
      return world_->relay_probe.handshakes_under_way.value() == kPlaces &&
             world_->relay_probe.handshakes_waiting.value() > 0;
    }));
    RawHttp2 client(Behind(ProxyHeaderFor(kSource), robot));
    EXPECT_TRUE(Streams(client));
  }
  EXPECT_GT(gave_way(), 0) << "a handshake of the crowd was cut for the other source";
  EXPECT_GT(TurnedAwayFor(*world_, TurnedAway::kCrowded), 0);
  for (const std::string& line : Lines()) {
    if (line.find("descriptors_few") != std::string::npos) continue;
    EXPECT_THAT(line, HasSubstr("source=203.0.113.66 "));
  }
}

// --- From whom a header is read ---

TEST_F(LoadBalancer, WhoIsNoneNeedsNoHeader) {
  EXPECT_TRUE(ServesNewRobot(*world_, 2));
  EXPECT_EQ(TurnedAwayForAll(), 0);
}

TEST_F(LoadBalancer, AHeaderOfWhoIsNoneIsTakenAsTls) {
  RawHttp2::Options options = ClientOf(*world_, RobotKeys(*world_, 1), "127.0.0.66");
  options.before_tls = ProxyHeaderFor(kSource);
  RawHttp2 liar(options);
  EXPECT_FALSE(liar.handshaken());
  EXPECT_TRUE(Eventually([&] { return TurnedAwayFor(*world_, TurnedAway::kNoTls) == 1; }));
  EXPECT_EQ(TurnedAwayForAll(), 1);
  EXPECT_THAT(Lines(), Contains(HasSubstr("source=127.0.0.66")));
}

TEST_F(LoadBalancer, WithoutAHeaderALoadBalancerIsTurnedAway) {
  RawHttp2 robot(Behind(""));
  EXPECT_FALSE(robot.handshaken());
  RawTcp old(port(), kLoadBalancer);
  static_cast<void>(old.SendSome("PROXY TCP4 203.0.113.7 127.0.0.1 4711 7443\r\n"));
  EXPECT_TRUE(old.WaitForEnd(kPatience));
  EXPECT_TRUE(Eventually([&] { return TurnedAwayFor(*world_, TurnedAway::kProxyHeader) == 2; }));
  EXPECT_EQ(TurnedAwayForAll(), 2);
  EXPECT_THAT(Lines(), Contains(AllOf(HasSubstr("source=127.0.0.9 peer=127.0.0.9:"),
                                      HasSubstr("why=proxy_header"))));
}

// --- Health checks ---

TEST_F(LoadBalancer, ItsHealthChecksMakeNoNoise) {
  {
    const RawTcp bare(port(), kLoadBalancer);
    const RawTcp bare_of_nobody(port(), "127.0.0.66");
    RawTcp local(port(), kLoadBalancer);
    EXPECT_EQ(local.SendSome(LocalProxyHeader()), 16U);
    // It looks whether TLS answers, and has no certificate.
    RawHttp2 tls(Behind(LocalProxyHeader(), KeyPair{}));
    EXPECT_TRUE(tls.ReadUntilEnd());
    // A connection that came later is through, so these have been seen.
    RawHttp2 robot(Behind(ProxyHeaderFor(kSource)));
    EXPECT_TRUE(Streams(robot));
  }
  EXPECT_TRUE(IsQuiet());
  EXPECT_EQ(TurnedAwayForAll(), 0);
  EXPECT_EQ(world_->relay_probe.handshakes_failed_total.value(), 0);
  EXPECT_THAT(Lines(), IsEmpty());
}

TEST_F(LoadBalancer, WhoHasACertificateIsNoMereHealthCheck) {
  RawHttp2 client(Behind(LocalProxyHeader()));
  ASSERT_TRUE(client.Begin());
  std::string pings;
  for (int i = 0; i < 10; ++i) pings += http2::Ping();
  client.Send(pings);
  EXPECT_TRUE(client.ReadUntilEnd());
  EXPECT_TRUE(Eventually([&] { return TurnedAwayFor(*world_, TurnedAway::kPings) == 1; }));
  EXPECT_THAT(Lines(), Contains(HasSubstr("source=127.0.0.9")));
}

// --- Who says nothing ---

TEST_F(LoadBalancer, AHeaderThatDoesNotComeIsWaitedForForSomeSeconds) {
  RawTcp silent(port(), kLoadBalancer);
  RawTcp half(port(), kLoadBalancer);
  static_cast<void>(half.SendSome(ProxyHeaderFor(kSource).substr(0, 20)));
  EXPECT_TRUE(Eventually([&] { return waiting() == 2; }));
  EXPECT_TRUE(silent.WaitForEnd(2 * front::kProxyHeaderWait));
  EXPECT_TRUE(half.WaitForEnd(2 * front::kProxyHeaderWait));
  EXPECT_TRUE(Eventually([&] { return waiting() == 0; }));
  EXPECT_EQ(TurnedAwayFor(*world_, TurnedAway::kProxyHeader), 2);
}

TEST_F(LoadBalancer, ThoseThatWaitAreBounded) {
  {
    const DescriptorLimit limit(kDescriptors);
    Make();
  }
  const std::size_t bound =
      front::DoorLimitsFor({.streams_max = world_->options.streams_max,
                            .descriptors_max = kDescriptors,
                            .reserved = transport::RelayOptions().descriptors_reserved,
                            .headers = front::ProxyHeaders::kExpected})
          .proxy_headers_max;
  std::vector<std::unique_ptr<RawTcp>> crowd;
  for (std::size_t i = 0; i < bound + 5; ++i) {
    crowd.push_back(std::make_unique<RawTcp>(port(), kLoadBalancer));
  }
  // Exactly so many: later all of them have waited too long.
  EXPECT_TRUE(Eventually([&] {
    return TurnedAwayFor(*world_, TurnedAway::kProxyHeader) == 5 &&
           waiting() == static_cast<std::int64_t>(bound);
  }));
  EXPECT_TRUE(crowd.front()->WaitForEnd(kPatience));
  RawHttp2 robot(Behind(ProxyHeaderFor(kSource)));
  EXPECT_TRUE(Streams(robot));
}

TEST_F(LoadBalancer, WhoWaitsIsClosedByADrainAndByAShutdown) {
  const std::size_t before = OpenDescriptors();
  for (const bool drain : {true, false}) {
    Make();
    RawTcp silent(port(), kLoadBalancer);
    RawTcp half(port(), kLoadBalancer);
    static_cast<void>(half.SendSome(ProxyHeaderFor(kSource).substr(0, 20)));
    EXPECT_TRUE(Eventually([&] { return waiting() == 2; }));
    if (drain) {
      world_->server().Drain(milliseconds(1000));
    } else {
      world_->StopServer();
    }
    EXPECT_TRUE(silent.WaitForEnd(kPatience));
    EXPECT_TRUE(half.WaitForEnd(kPatience));
    EXPECT_EQ(waiting(), 0);
    EXPECT_EQ(TurnedAwayForAll(), 0);
  }
  Make();
  EXPECT_EQ(OpenDescriptors(), before);
}

TEST_F(LoadBalancer, NoDescriptorIsLost) {
  const std::size_t before = OpenDescriptors();
  for (int i = 0; i < 50; ++i) {
    const RawTcp bare(port(), kLoadBalancer);
    RawTcp wrong(port(), kLoadBalancer);
    static_cast<void>(wrong.SendSome("GET / HTTP/1.1\r\n"));
    RawTcp local(port(), kLoadBalancer);
    static_cast<void>(local.SendSome(LocalProxyHeader()));
    RawTcp half(port(), kLoadBalancer);
    static_cast<void>(half.SendSome(ProxyHeaderFor(kSource).substr(0, 20)));
    RawTcp no_tls(port(), kLoadBalancer);
    static_cast<void>(no_tls.SendSome(ProxyHeaderFor(kSource) + "no TLS"));
  }
  EXPECT_TRUE(Eventually([&] { return TurnedAwayFor(*world_, TurnedAway::kNoTls) == 50; }));
  EXPECT_TRUE(IsQuiet());
  EXPECT_TRUE(Eventually([&] { return OpenDescriptors() == before; }))
      << OpenDescriptors() << " and there were " << before;
}

}  // namespace
}  // namespace uplink::testing
