#include "tests/component/front/front_threads.h"
#include "tests/support/relay_bytes.h"

namespace uplink::testing {
namespace {

using transport::TurnedAway;

/// A frame that never becomes whole takes so much, and all of a thread a little more.
constexpr std::uint32_t kHeldBytes = 40'000;
constexpr std::size_t kUnfinishedBytes = 3 * kHeldBytes;

TEST_F(FrontThreads, RobotsComeBackFromEveryWayOfLeaving) {
  ForEachRobot([](RawRobot& robot) {
    for (int round = 0; round < kRounds; ++round) {
      ASSERT_TRUE(robot.Connect());
      for (int i = 0; i < kBatches; ++i) ASSERT_TRUE(robot.StreamBatch());
      if (round % 3 == 0) {
        ASSERT_TRUE(robot.HalfClose());
      }
      if (round % 3 == 1) robot.Reset();
      if (round % 3 == 2) robot.Cut();
    }
  });
  for (const auto& robot : robots_)
    EXPECT_EQ(robot->acked(), kRounds * kBatches * RawRobot::kBatch);
}

/// Its streams take over from each other, across connections and threads, and its connections are
/// too many.
TEST_F(FrontThreads, OneKeyInManyHandsIsServedInTheEnd) {
  std::vector<std::jthread> hands;
  hands.reserve(kRobots);
  for (int hand = 0; hand < kRobots; ++hand) {
    hands.emplace_back([this, hand] {
      std::vector<std::unique_ptr<RawHttp2>> held(2);
      for (int i = 0; i < kRounds; ++i) {
        auto& client = held[static_cast<std::size_t>(i) % held.size()];
        client = std::make_unique<RawHttp2>(ClientOf(world_, keys_[0]));
        if (!client->Begin()) continue;
        client->Send(OpenRelay(1) +
                     http2::Data(1, HelloMessage(static_cast<std::uint8_t>(10 + hand)) +
                                        FaultsMessage(static_cast<model::Seq>(i) + 1, 1)));
        static_cast<void>(client->Sync());
      }
    });
  }
  hands.clear();
  EXPECT_GT(TurnedAwayFor(world_, TurnedAway::kKey), 0);
  EXPECT_GT(world_.session_probe.takeovers_total.value(), 0);
  EXPECT_TRUE(Eventually([this] { return robots_[0]->Connect() && robots_[0]->StreamBatch(); }));
  robots_[0]->Cut();
}

// --- Beside attackers ---

class FrontThreadsAttacked : public FrontThreads {
 protected:
  static ListenerWorld::Options Options() {
    ListenerWorld::Options options = ManyThreads();
    // A fourth of it is for unfinished frames, and each thread has its part.
    options.memory_bytes_max = kThreads * 4 * kUnfinishedBytes;
    return options;
  }
  FrontThreadsAttacked() : FrontThreads(Options()) {}

  [[nodiscard]] RawHttp2::Options Attacker(const KeyPair& keys) const {
    return ClientOf(world_, keys, "127.0.0.66");
  }
  /// Streams that end where they begin, until it is turned away.
  static void Resets(const RawHttp2::Options& options) {
    RawHttp2 client(options);
    if (!client.Begin()) return;
    for (std::uint32_t stream = 1; client.open() && stream < 2'000; stream += 2) {
      client.Send(OpenRelay(stream) + http2::Data(stream, HelloMessage(1)) +
                  http2::RstStream(stream, http2::kCancel));
    }
    EXPECT_TRUE(client.ReadUntilEnd());
  }
  /// A frame on each of many streams that never becomes whole.
  static void Halves(const RawHttp2::Options& options) {
    RawHttp2 client(options);
    if (!client.Begin()) return;
    for (std::uint32_t stream = 1; stream < 17; stream += 2) {
      client.Send(OpenRelay(stream));
      static_cast<void>(client.SendData(stream, Prefix(500'000) + std::string(kHeldBytes, 'x'),
                                        milliseconds(2'000)));
    }
    static_cast<void>(client.Sync());
  }
  /// Handshakes that are not finished, or show nothing.
  void Strangers() {
    for (int i = 0; i < kRounds; ++i) {
      RawTcp half(world_.port(), "127.0.0.66");
      static_cast<void>(half.SendSome(hello_));
      RawTcp garbage(world_.port(), "127.0.0.66");
      static_cast<void>(garbage.SendSome("GET / HTTP/1.1\r\n\r\n"));
      const RawHttp2 nobody(Attacker({}));
    }
  }

  const std::string hello_ = TlsClientHello();
};

TEST_F(FrontThreadsAttacked, HonestRobotsLoseNothing) {
  std::vector<std::jthread> attackers;
  for (int i = 0; i < 3; ++i) {
    const RawHttp2::Options options = Attacker(RobotKeys(world_, 600 + i));
    attackers.emplace_back([options] { Resets(options); });
    attackers.emplace_back([options] { Halves(options); });
    attackers.emplace_back([this] { Strangers(); });
  }
  ForEachRobot([](RawRobot& robot) {
    ASSERT_TRUE(robot.Connect());
    for (int i = 0; i < kRounds * kBatches; ++i) ASSERT_TRUE(robot.StreamBatch());
    EXPECT_TRUE(robot.HalfClose());
  });
  attackers.clear();
  EXPECT_GT(TurnedAwayFor(world_, TurnedAway::kResets), 0);
  EXPECT_GT(TurnedAwayFor(world_, TurnedAway::kNoTls), 0);
  EXPECT_GT(TurnedAwayFor(world_, TurnedAway::kNoCertificate), 0);
}

}  // namespace
}  // namespace uplink::testing
