// What bytes on a connection tell of a robot's presence, by TLS and on a clock that is moved by
// hand.
#include <optional>
#include <string>
#include <string_view>

#include <gtest/gtest.h>

#include "server/session/slow_frame.h"
#include "tests/component/front/connection_bench.h"
#include "tests/support/relay_bytes.h"

namespace uplink::testing {
namespace {

using fleet::Fleet;
using std::chrono::seconds;

/// So far apart a client may ask by a PING whether its bytes were taken, within presence.timeout.
constexpr int kPieceSeconds = 9;

/// A robot that streams and was heard just now; the grace of the start is over.
class FrontPresence : public ::testing::Test {
 protected:
  static constexpr std::uint32_t kStream = 1;

  void SetUp() override {
    Step(seconds(121), 1);
    client_.emplace(bench_.Client(bench_.authority().Issue(RobotSpec(fuzz::RuriOf(1)))));
    ASSERT_TRUE(robot().Begin());
    robot().Send(OpenRelay(kStream) + http2::Data(kStream, HelloMessage(1)));
    ASSERT_TRUE(IsWelcome(robot(), kStream));
    ASSERT_TRUE(Speak(robot(), kStream, 1));
    ASSERT_EQ(Presence(), robot::Presence::kOnline);
  }
  [[nodiscard]] RawHttp2& robot() { return *client_; }
  [[nodiscard]] bool IsWelcome(RawHttp2& client, std::uint32_t stream) {
    return Eventually([&] {
      bench_.Commit();
      return client.ReadUntil([&] { return !FramesOf(client.At(stream)).empty(); },
                              milliseconds(20));
    });
  }
  /// A sign of life, once the server has taken it.
  [[nodiscard]] bool Speak(RawHttp2& client, std::uint32_t stream, model::Seq seq) {
    const auto received = [this] { return bench_.bench().counts().received; };
    const auto before = received();
    const std::string frame = BatchFrame({{seq, MotionPayload()}}).SerializeAsString();
    client.Send(http2::Data(stream, WithPrefix(frame)));
    return Eventually([&] { return received() > before; });
  }
  /// So many steps of time, with a sweep after each.
  void Step(milliseconds time, int steps) {
    for (int i = 0; i < steps; ++i) {
      bench_.Pass(time);
      bench_.Do([this] {
        bench_.bench().fleet().Sweep(std::chrono::hours(1), hearing_);
        bench_.bench().DeliverWakes();
      });
    }
  }
  [[nodiscard]] robot::Presence Presence(std::uint8_t number = 1) {
    return bench_.bench().fleet().Find(fuzz::RuriOf(number))->state.presence();
  }

  Fleet::HearingState hearing_ = Fleet::HearingState::kUpToDate;
  ConnectionBench bench_;

 private:
  std::optional<RawHttp2> client_;
};

TEST_F(FrontPresence, AFrameOverASlowLinkKeepsItsRobotOnline) {
  const std::string frame =
      WithPrefix(BatchFrame({{2, std::string(80'000, 'x')}}).SerializeAsString());
  constexpr int kPieces = session::kSlowFrameMax.count() / kPieceSeconds;
  const std::size_t piece = frame.size() / kPieces + 1;
  for (std::size_t at = 0; at < frame.size(); at += piece) {
    const std::string_view bytes = std::string_view(frame).substr(at, piece);
    ASSERT_EQ(robot().SendData(kStream, bytes), bytes.size());
    ASSERT_TRUE(robot().Sync());
    ASSERT_EQ(Presence(), robot::Presence::kOnline) << "after " << at << " bytes";
    if (at + piece >= frame.size()) break;
    Step(seconds(1), kPieceSeconds);
    ASSERT_EQ(Presence(), robot::Presence::kOnline) << "after " << at << " bytes";
  }
  EXPECT_EQ(bench_.bench().counts().received, 2U);
}

TEST_F(FrontPresence, APeerThatDripsKeepsNobodyOnlineForLongerThanAMinutePerFrame) {
  const std::string frame =
      WithPrefix(BatchFrame({{2, std::string(1'000, 'x')}}).SerializeAsString());
  std::size_t sent = 0;
  const auto drip = [&](std::size_t bytes) {
    robot().Send(http2::Data(kStream, frame.substr(sent, bytes)));
    sent += bytes;
    return robot().Sync();
  };
  for (int passed = 0; passed <= session::kSlowFrameMax.count(); passed += kPieceSeconds) {
    ASSERT_TRUE(drip(1));
    Step(seconds(1), kPieceSeconds);
    EXPECT_EQ(Presence(), robot::Presence::kOnline) << passed << " s";
  }
  for (int i = 0; i < 5; ++i) {
    ASSERT_TRUE(drip(1));
    Step(seconds(1), kPieceSeconds);
    EXPECT_EQ(Presence(), robot::Presence::kOffline);
  }
  // It is whole at last, no sign of life itself, and another one may begin.
  ASSERT_TRUE(drip(frame.size() - sent));
  EXPECT_EQ(Presence(), robot::Presence::kOffline);
  Step(seconds(1), kPieceSeconds);
  sent = 0;
  ASSERT_TRUE(drip(1));
  EXPECT_EQ(Presence(), robot::Presence::kOnline);
}

/// Another server is cut off from the store, and may hear a robot that left us.
class FrontDoubt : public FrontPresence {
 protected:
  FrontDoubt() { hearing_ = Fleet::HearingState::kHereAlone; }

  [[nodiscard]] static bool IsPinged(RawHttp2& client, std::size_t pings) {
    return client.ReadUntil([&] { return client.pings() == pings; });
  }
  /// Once an answer that was sent has come.
  [[nodiscard]] bool BecomesOffline(std::uint8_t number = 1) {
    return Eventually([&] {
      Step(milliseconds(1), 1);
      return Presence(number) == robot::Presence::kOffline;
    });
  }
};

TEST_F(FrontDoubt, AHalfOpenConnectionMakesNobodyOffline) {
  Step(seconds(1), 9);
  ASSERT_TRUE(robot().Sync());
  EXPECT_EQ(robot().pings(), 0U);
  Step(seconds(1), 1);
  EXPECT_TRUE(IsPinged(robot(), 1)) << "at presence.timeout";
  EXPECT_EQ(Presence(), robot::Presence::kOnline);
  // Each sweep asks again, and one PING is under way.
  Step(seconds(1), 20);
  EXPECT_EQ(Presence(), robot::Presence::kUnknown);
  ASSERT_TRUE(robot().Sync());
  EXPECT_EQ(robot().pings(), 1U);
  Step(seconds(1), 1);
  EXPECT_EQ(Presence(), robot::Presence::kUnknown) << "what is no answer to it is no evidence";
}

TEST_F(FrontDoubt, WhoAnswersAndIsSilentIsOffline) {
  Step(seconds(1), 10);
  ASSERT_TRUE(IsPinged(robot(), 1));
  robot().Send(http2::Pong());
  EXPECT_TRUE(BecomesOffline());
}

TEST_F(FrontDoubt, AnAnswerThatComesLateCounts) {
  Step(seconds(1), 20);
  ASSERT_EQ(Presence(), robot::Presence::kUnknown);
  robot().Send(http2::Pong());
  EXPECT_TRUE(BecomesOffline());
}

TEST_F(FrontDoubt, WhoIsHeardAgainIsOnlineAndAskedAnewForItsNextSilence) {
  Step(seconds(1), 12);
  ASSERT_TRUE(Speak(robot(), kStream, 2));
  EXPECT_EQ(Presence(), robot::Presence::kOnline);
  robot().Send(http2::Pong());
  ASSERT_TRUE(robot().Sync()) << "an answer of the silence before";
  Step(seconds(1), 11);
  EXPECT_EQ(Presence(), robot::Presence::kUnknown);
  EXPECT_TRUE(IsPinged(robot(), 2));
}

TEST_F(FrontDoubt, WhileNobodyElseMayHearItNobodyIsAsked) {
  hearing_ = Fleet::HearingState::kUpToDate;
  Step(seconds(1), 11);
  EXPECT_EQ(Presence(), robot::Presence::kOffline);
  ASSERT_TRUE(robot().Sync());
  EXPECT_EQ(robot().pings(), 0U);
}

TEST_F(FrontDoubt, AnAnswerOfAGatewayCountsForEachOfItsRobotsThatAsked) {
  constexpr std::uint32_t kFirst = 1;
  constexpr std::uint32_t kSecond = 3;
  CertificateSpec spec;
  spec.common_names = {"gateway"};
  spec.units = {"gateway"};
  spec.uris = {fuzz::RuriOf(0), fuzz::RuriOf(2)};
  RawHttp2 gateway(bench_.Client(bench_.authority().Issue(spec)));
  ASSERT_TRUE(gateway.Begin());
  gateway.Send(OpenRelay(kFirst) + http2::Data(kFirst, HelloMessage(1, fuzz::RuriOf(0))) +
               OpenRelay(kSecond) + http2::Data(kSecond, HelloMessage(1, fuzz::RuriOf(2))));
  ASSERT_TRUE(IsWelcome(gateway, kFirst) && IsWelcome(gateway, kSecond));
  ASSERT_TRUE(Speak(gateway, kFirst, 1));
  Step(seconds(1), 5);
  ASSERT_TRUE(Speak(gateway, kSecond, 1));
  Step(seconds(1), 5);
  ASSERT_TRUE(IsPinged(gateway, 1)) << "for the first";
  gateway.Send(http2::Pong());
  ASSERT_TRUE(BecomesOffline(0));
  EXPECT_EQ(Presence(2), robot::Presence::kOnline);
  Step(seconds(1), 6);
  EXPECT_EQ(Presence(2), robot::Presence::kUnknown) << "no answer to the ping for its own silence";
  ASSERT_TRUE(IsPinged(gateway, 2));
  gateway.Send(http2::Pong());
  EXPECT_TRUE(BecomesOffline(2));
}

}  // namespace
}  // namespace uplink::testing
