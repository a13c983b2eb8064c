// What ends a connection after some time, on a clock that is moved by hand.
#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "server/front/lifetime.h"
#include "tests/component/front/connection_bench.h"
#include "tests/support/raw_tcp.h"
#include "tests/support/relay_bytes.h"

namespace uplink::testing {
namespace {

using transport::TurnedAway;

constexpr milliseconds kMoment{20};

class HandshakeWait : public ::testing::Test {
 protected:
  /// A peer that has begun its handshake, and stops.
  void StopInTheMiddle() {
    peer_.emplace(bench_.port());
    bench_.Accept();
    const std::string hello = TlsClientHello();
    ASSERT_EQ(peer_->SendSome(hello), hello.size());
    ASSERT_TRUE(Eventually([this] { return !peer_->Receive().empty(); })) << "it is answered";
  }
  void ExpectUnderWay() {
    EXPECT_EQ(bench_.open(), 1U);
    EXPECT_EQ(bench_.TurnedAwayFor(TurnedAway::kHandshakeTimeout), 0);
  }
  void ExpectCut() {
    EXPECT_EQ(bench_.open(), 0U);
    EXPECT_EQ(bench_.TurnedAwayFor(TurnedAway::kHandshakeTimeout), 1);
    EXPECT_EQ(bench_.bench().relay_probe().handshakes_failed_total.value(), 1);
    EXPECT_TRUE(peer_->WaitForEnd(kPatience));
  }

  ConnectionBench bench_;
  std::optional<RawTcp> peer_;
};

TEST_F(HandshakeWait, IsTwentySeconds) {
  ASSERT_NO_FATAL_FAILURE(StopInTheMiddle());
  bench_.Pass(front::kHandshakeWaitPressed + kMoment);
  ExpectUnderWay();
  bench_.Pass(front::kHandshakeWait - front::kHandshakeWaitPressed - 2 * kMoment);
  ExpectUnderWay();
  bench_.Pass(2 * kMoment);
  ExpectCut();
}

TEST_F(HandshakeWait, IsFiveSecondsWhileOthersWait) {
  bench_.Press();
  ASSERT_NO_FATAL_FAILURE(StopInTheMiddle());
  bench_.Pass(front::kHandshakeWaitPressed - kMoment);
  ExpectUnderWay();
  bench_.Pass(2 * kMoment);
  ExpectCut();
}

TEST_F(HandshakeWait, IsOverASecondAfterOthersCome) {
  ASSERT_NO_FATAL_FAILURE(StopInTheMiddle());
  bench_.Pass(front::kHandshakeWaitPressed + kMoment);
  bench_.Press();
  ExpectUnderWay();
  bench_.Pass(front::kLookAgain);
  ExpectCut();
}

TEST_F(HandshakeWait, IsNoLongerForWhoSaysNothingAtAll) {
  peer_.emplace(bench_.port());
  bench_.Accept();
  bench_.Pass(front::kHandshakeWait - kMoment);
  ExpectUnderWay();
  bench_.Pass(2 * kMoment);
  ExpectCut();
}

TEST_F(HandshakeWait, EndsWithTheHandshake) {
  RawHttp2 client(bench_.Client(bench_.authority().Issue(RobotSpec(fuzz::RuriOf(1)))));
  ASSERT_TRUE(client.Begin());
  client.Send(OpenRelay(1) + http2::Data(1, HelloMessage(1)));
  ASSERT_TRUE(client.Sync());
  bench_.Commit();
  ASSERT_TRUE(client.ReadUntil([&] { return !FramesOf(client.At(1)).empty(); }));
  bench_.Pass(front::kHandshakeWait + kMoment);
  EXPECT_TRUE(client.Sync());
  EXPECT_EQ(bench_.TurnedAwayFor(TurnedAway::kHandshakeTimeout), 0);
}

// --- The end of a certificate ---

/// A robot that streams, with a certificate of an hour.
class CertificateEnd : public ::testing::Test {
 protected:
  /// How often something must be heard of a peer that is there.
  static constexpr std::chrono::seconds kStep{20};

  void SetUp() override {
    ASSERT_TRUE(robot_.Begin());
    robot_.Send(OpenRelay(1) + http2::Data(1, HelloMessage(1) + FaultsMessage(1, 1)));
    ASSERT_TRUE(IsAcked(1));
  }

  [[nodiscard]] bool IsAcked(model::Seq seq) {
    if (!robot_.Sync()) return false;
    bench_.Commit();
    return robot_.ReadUntil([&] { return LastAck(robot_.At(1)).through_seq() == seq; });
  }
  /// The civil clock stands so long before the certificate's end.
  void SetClockBeforeEnd(std::chrono::seconds left) {
    bench_.Do([&] { bench_.bench().clock().SetSystem(begun_ + kLife - left); });
  }
  /// Long enough for a look at the certificate.
  void PassALook() {
    for (std::chrono::seconds passed{0}; passed <= front::kExpiryLook; passed += kStep) {
      bench_.Pass(kStep);
      if (!robot_.Sync()) return;
    }
  }
  [[nodiscard]] std::size_t Drains() const {
    std::size_t drains = 0;
    for (const v1::RelayResponse& frame : FramesOf(robot_.At(1))) drains += frame.has_drain();
    return drains;
  }
  [[nodiscard]] std::int64_t EndedUnavailable() {
    return bench_.bench()
        .session_probe()
        .ended_total[static_cast<std::size_t>(
            std::find(session::kStreamEnds.begin(), session::kStreamEnds.end(), "unavailable") -
            session::kStreamEnds.begin())]
        .value();
  }

  static constexpr std::chrono::seconds kLife{3600};
  ConnectionBench bench_;
  const SystemTime begun_ = SystemClock{}.System();
  RawHttp2 robot_{bench_.Client(bench_.authority().Issue(RobotSpec(fuzz::RuriOf(1))))};
};

TEST_F(CertificateEnd, EndsALiveConnectionInOrder) {
  SetClockBeforeEnd(2 * front::kBeforeExpiry);
  PassALook();
  ASSERT_EQ(Drains(), 0U) << "there is time";
  EXPECT_TRUE(robot_.open());
  SetClockBeforeEnd(std::chrono::seconds(1));
  PassALook();
  ASSERT_TRUE(robot_.ReadUntil([&] { return Drains() == 1; }));
  bench_.Commit();
  ASSERT_TRUE(robot_.ReadUntilOver(1));
  EXPECT_EQ(LastAck(robot_.At(1)).through_seq(), 1U);
  EXPECT_EQ(StatusOf(robot_.At(1)), "14");
  EXPECT_EQ(EndedUnavailable(), 1);
  EXPECT_TRUE(robot_.ReadUntilEnd());
  EXPECT_EQ(robot_.end(), RawTcp::End::kClosed);
  EXPECT_EQ(robot_.goaway_code(), http2::kNoError);
}

TEST_F(CertificateEnd, IsNothingToAClockThatNobodyVouchesFor) {
  bench_.bench().clock_trust().Set(false);
  SetClockBeforeEnd(std::chrono::seconds(-3600));
  PassALook();
  robot_.Send(http2::Data(1, FaultsMessage(2, 1)));
  EXPECT_TRUE(IsAcked(2)) << "it goes on";
  EXPECT_EQ(Drains(), 0U);

  bench_.bench().clock_trust().Set(true);
  PassALook();
  EXPECT_TRUE(robot_.ReadUntil([&] { return Drains() == 1; })) << "and ends once somebody does";
}

// --- Who lingers ---

/// Peers whose authority is another one are told so by an alert, behind which they are read on.
class Lingering : public ::testing::Test {
 protected:
  static constexpr std::size_t kMax = fuzz::FrontBench::kLingersMax;

  /// Comes, is turned away, and stays as long as it may.
  RawHttp2& Come() {
    clients_.push_back(
        std::make_unique<RawHttp2>(bench_.Client(foreign_.Issue(RobotSpec(fuzz::RuriOf(1))))));
    ++came_;
    EXPECT_TRUE(
        Eventually([this] { return bench_.TurnedAwayFor(TurnedAway::kUntrusted) == came_; }));
    // What follows the count is done by now.
    bench_.Do([] {});
    return *clients_.back();
  }

  ConnectionBench bench_;
  const TestAuthority foreign_{"another authority"};
  std::vector<std::unique_ptr<RawHttp2>> clients_;
  std::int64_t came_ = 0;
};

TEST_F(Lingering, IsBoundedAndWhoIsOneTooManyIsClosedAtOnce) {
  for (std::size_t i = 0; i < kMax; ++i) Come();
  EXPECT_EQ(bench_.open(), kMax);
  for (int i = 0; i < 20; ++i) {
    RawHttp2& more = Come();
    EXPECT_TRUE(more.ReadUntilEnd());
    EXPECT_EQ(bench_.open(), kMax);
  }
  EXPECT_EQ(bench_.bench().relay_probe().handshakes_failed_total.value(), came_);
  EXPECT_EQ(bench_.bench().relay_probe().connections.value(), 0);
}

TEST_F(Lingering, IsOverAfterASecondAndThenOthersMay) {
  for (std::size_t i = 0; i < kMax; ++i) Come();
  bench_.Pass(front::kLingerWait - kMoment);
  EXPECT_EQ(bench_.open(), kMax);
  bench_.Pass(2 * kMoment);
  EXPECT_EQ(bench_.open(), 0U);
  Come();
  EXPECT_EQ(bench_.open(), 1U);
}

TEST_F(Lingering, ReadsSoManyTimesAtMost) {
  RawTcp peer(bench_.port());
  bench_.Accept();
  // A record of a handshake whose message is none.
  const std::string broken("\x16\x03\x01\x00\x05\xFF\x00\x00\x01\x00", 10);
  ASSERT_EQ(peer.SendSome(broken), broken.size());
  ASSERT_TRUE(Eventually([&] { return !peer.Receive().empty(); })) << "it is told by an alert";
  const auto come = [&] {
    static_cast<void>(peer.SendSome("x"));
    bench_.Do([] {});
  };
  for (std::size_t i = 0; i < front::kLingerReadsMax / 2; ++i) come();
  EXPECT_EQ(bench_.open(), 1U);
  // The clock stands still: nothing else ends it.
  for (std::size_t i = 0; i < 10 * front::kLingerReadsMax && bench_.open() > 0; ++i) come();
  EXPECT_TRUE(Eventually([&] { return bench_.open() == 0; }));
}

}  // namespace
}  // namespace uplink::testing
