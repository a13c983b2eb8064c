// Requests that announce, open or say too much.
#include <string>
#include <tuple>

#include "tests/component/front/hostile.h"
#include "tests/support/attack_bytes.h"

namespace uplink::testing {
namespace {

using transport::TurnedAway;

class HostileRequests : public Hostile {
 protected:
  void SetUp() override {
    ASSERT_NO_FATAL_FAILURE(Hostile::SetUp());
    ASSERT_TRUE(robot_.Begin());
  }

  RawHttp2 robot_{Attacker()};
};

TEST_F(HostileRequests, AnnouncementsOf600MegabytesOnManyStreams) {
  constexpr std::uint32_t kStreams = 128;
  RawHttp2 gateway(ClientOf(world_, GatewayKeys(world_)));
  ASSERT_TRUE(gateway.Begin());
  for (std::uint32_t i = 0; i < kStreams; ++i) {
    gateway.Send(attack::Announcement(2 * i + 1, 600'000'000, 1000));
  }
  ExpectVictimGoesOn();
  for (std::uint32_t i = 0; i < kStreams; ++i) {
    ASSERT_TRUE(gateway.ReadUntilOver(2 * i + 1));
    EXPECT_EQ(StatusOf(gateway.At(2 * i + 1)), "8");
  }
}

TEST_F(HostileRequests, TenThousandStreams) {
  robot_.Send(attack::Opened(1, 10'000));
  ExpectVictimGoesOn();
  EXPECT_TRUE(robot_.ReadUntilEnd());
  EXPECT_TRUE(robot_.goaway_code());
  EXPECT_EQ(
      TurnedAwayFor(world_, TurnedAway::kProtocol) + TurnedAwayFor(world_, TurnedAway::kHeaders),
      1);
  EXPECT_LT(world_.session_probe.streams_total.value(), 100);
}

TEST_F(HostileRequests, TenThousandStreamsWithoutHavingReadTheLimit) {
  RawHttp2 hasty(Attacker());
  hasty.Send(http2::Preface() + http2::Settings({}) + attack::Opened(1, 10'000));
  ExpectVictimGoesOn();
  EXPECT_TRUE(hasty.ReadUntilEnd());
  EXPECT_EQ(hasty.goaway_code(), http2::kEnhanceYourCalm);
  EXPECT_TRUE(Turned(TurnedAway::kHeaders));
  EXPECT_LT(world_.session_probe.streams_total.value(), 100);
}

TEST_F(HostileRequests, ManyRefusedRequests) {
  std::string flood;
  for (std::uint32_t i = 0; i < 10'000; ++i) {
    flood += http2::Headers(2 * i + 1, RelayFields({{":path", "/nothing"}}),
                            http2::kEndHeaders | http2::kEndStream);
  }
  robot_.Send(flood);
  ExpectVictimGoesOn();
  EXPECT_TRUE(robot_.ReadUntilEnd());
  // Whether more are open at once than may be hangs on how they arrive.
  const bool too_many = TurnedAwayFor(world_, TurnedAway::kProtocol) == 1;
  EXPECT_EQ(robot_.goaway_code(), too_many ? http2::kProtocolError : http2::kEnhanceYourCalm);
  EXPECT_EQ(TurnedAwayFor(world_, TurnedAway::kHeaders), too_many ? 0 : 1);
}

TEST_F(HostileRequests, HeadersFarOverTheirLimitEndTheirConnection) {
  // The bomb names an entry of the dynamic table thousands of times: a byte on the wire is 4 KB of
  // headers. A single long field is past what nghttp2 decodes.
  for (const auto& [bytes, code, cause] :
       {std::tuple{attack::LongHeader(1, 200'000), http2::kCompressionError, TurnedAway::kProtocol},
        std::tuple{attack::HeaderBombFuse(1) + attack::HeaderBomb(3), http2::kEnhanceYourCalm,
                   TurnedAway::kHeaders},
        std::tuple{attack::HeaderBombFuse(1) + attack::HeaderBombInTrailers(1),
                   http2::kEnhanceYourCalm, TurnedAway::kHeaders}}) {
    const std::int64_t before = TurnedAwayFor(world_, cause);
    RawHttp2 attacker(Attacker());
    ASSERT_TRUE(attacker.Begin());
    attacker.Send(bytes);
    ExpectVictimGoesOn();
    EXPECT_TRUE(attacker.ReadUntilEnd());
    EXPECT_EQ(attacker.goaway_code(), code);
    EXPECT_EQ(TurnedAwayFor(world_, cause), before + 1);
  }
}

/// An agent with too many headers is told so, and its connection goes on.
TEST_F(HostileRequests, HeadersOverTheLimitEndTheirStreamAlone) {
  robot_.Send(OpenRelay(1, {{"x-long", std::string(10'000, 'x')}}));
  EXPECT_TRUE(robot_.ReadUntilOver(1));
  EXPECT_EQ(StatusOf(robot_.At(1)), "8");
  EXPECT_TRUE(robot_.Sync());
}

TEST_F(HostileRequests, EndlessContinuations) {
  robot_.Send(attack::HeadersWithoutEnd(1));
  const std::string more = attack::EndlessContinuation(1);
  for (int i = 0; i < 300; ++i) {
    if (!robot_.Send(more)) break;
  }
  ExpectVictimGoesOn();
  EXPECT_TRUE(robot_.ReadUntilEnd());
  if (robot_.end() != RawTcp::End::kReset) {
    EXPECT_EQ(robot_.goaway_code(), http2::kEnhanceYourCalm);
  }
  EXPECT_EQ(TurnedAwayFor(world_, TurnedAway::kHeaders), 1) << "its fields, before their number";
}

TEST_F(HostileRequests, MessagesThatAreAnnouncedAndNeverCome) {
  std::vector<std::unique_ptr<RawHttp2>> robots;
  for (int i = 0; i < 20; ++i) {
    robots.push_back(std::make_unique<RawHttp2>(ClientOf(world_, RobotKeys(world_, 700 + i))));
    ASSERT_TRUE(robots.back()->Begin());
    for (std::uint32_t stream = 1; stream <= 15; stream += 2) {
      robots.back()->Send(attack::Announcement(stream, 200'000, 100));
    }
  }
  ExpectVictimGoesOn();
}

/// The peer does not read its answers: what waits for one peer is bounded.
TEST_F(HostileRequests, APeerThatOpensNoWindow) {
  robot_.Send(http2::Settings({{http2::kInitialWindowSize, 0}}) + OpenRelay(1));
  EXPECT_EQ(robot_.SendData(1, HelloMessage(1), kPatience), HelloMessage(1).size());
  model::Seq seq = 1;
  while (robot_.SendData(1, WithPrefix(BatchFrame({{seq, "rubbish"}}).SerializeAsString()),
                         std::chrono::milliseconds(200)) > 0) {
    if (++seq > 20'000) break;
  }
  EXPECT_LT(seq, 20'000U) << "the stream is held back";
  ExpectVictimGoesOn();
  robot_.Send(http2::RstStream(1, http2::kCancel));
}

}  // namespace
}  // namespace uplink::testing
