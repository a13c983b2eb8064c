// Floods of frames that cost their sender nearly nothing.
#include <string>

#include "tests/component/front/hostile.h"
#include "tests/support/attack_bytes.h"

namespace uplink::testing {
namespace {

using transport::TurnedAway;

constexpr std::size_t kFrames = 20'000;

class HostileFrames : public Hostile {
 protected:
  void SetUp() override {
    ASSERT_NO_FATAL_FAILURE(Hostile::SetUp());
    ASSERT_TRUE(attacker_.Begin());
  }

  /// Sends the flood, in parts, until it is over or the server has ended the connection, and
  /// expects that it has, for this.
  void ExpectEnded(std::string_view flood, TurnedAway cause, std::uint32_t code) {
    while (!flood.empty() && attacker_.Send(flood.substr(0, RawTcp::kReceiveBytesMax))) {
      flood.remove_prefix(std::min(flood.size(), RawTcp::kReceiveBytesMax));
      static_cast<void>(attacker_.ReadUntil([] { return false; }, std::chrono::milliseconds(1)));
    }
    ExpectVictimGoesOn();
    EXPECT_TRUE(attacker_.ReadUntilEnd());
    EXPECT_EQ(attacker_.goaway_code(), code) << attacker_.goaway_text();
    EXPECT_TRUE(Turned(cause));
    EXPECT_EQ(TurnedAwayFor(world_, cause), 1);
  }
  void ExpectCalmed(std::string_view flood, TurnedAway cause) {
    ExpectEnded(flood, cause, http2::kEnhanceYourCalm);
  }

  RawHttp2 attacker_{Attacker()};
};

/// DATA with this content, and so many bytes of padding.
std::string PaddedData(std::uint32_t stream, std::string_view content, std::uint8_t padding) {
  std::string payload(1, static_cast<char>(padding));
  payload.append(content);
  payload.append(padding, '\0');
  return http2::Frame(http2::kData, http2::kPadded, stream, payload);
}

struct Flood {
  const char* name;
  /// What comes once, and what comes again and again.
  std::string first;
  std::string again;
  TurnedAway cause;
  std::uint32_t code = http2::kEnhanceYourCalm;
};

class HostileFlood : public HostileFrames, public ::testing::WithParamInterface<Flood> {};

TEST_P(HostileFlood, EndsItsConnection) {
  const auto& [name, first, again, cause, code] = GetParam();
  ExpectEnded(first + http2::Times(kFrames, again), cause, code);
}

INSTANTIATE_TEST_SUITE_P(
    Cheap, HostileFlood,
    ::testing::Values(
        Flood{"Settings", "", http2::Settings({{http2::kMaxConcurrentStreams, 1}}),
              TurnedAway::kSettings},
        Flood{"AnswersToPingsThatNobodySent", "",
              http2::Frame(http2::kPing, http2::kAck, 0, "pingping"), TurnedAway::kPongs},
        Flood{"EmptyData", OpenRelay(1), http2::Data(1, ""), TurnedAway::kEmptyData},
        Flood{"DataOfALengthByteAlone", OpenRelay(1), PaddedData(1, "", 0), TurnedAway::kEmptyData},
        Flood{"DataOfPaddingAlone", OpenRelay(1), PaddedData(1, "", 255), TurnedAway::kEmptyData},
        Flood{"Priorities", "", http2::Priority(1), TurnedAway::kPriorities},
        Flood{"WindowUpdates", OpenRelay(1), http2::WindowUpdate(1, 1), TurnedAway::kWindowUpdates},
        Flood{"UnknownTypes", "", http2::Frame(http2::kUnknown, 0, 0, "x"),
              TurnedAway::kUnknownFrames},
        Flood{"EmptyContinuations", attack::HeadersWithoutEnd(1),
              http2::Frame(http2::kContinuation, 0, 1), TurnedAway::kContinuations}),
    [](const auto& instance) { return instance.param.name; });

INSTANTIATE_TEST_SUITE_P(
    Wrong, HostileFlood,
    ::testing::Values(Flood{"Garbage", std::string(100'000, '\xFF'), "", TurnedAway::kProtocol,
                            http2::kFrameSizeError},
                      Flood{"AWindowUpdateOfNothing", http2::WindowUpdate(0, 0), "",
                            TurnedAway::kProtocol, http2::kProtocolError},
                      Flood{"AWindowThatOverflows", http2::WindowUpdate(0, 0x7FFFFFFF), "",
                            TurnedAway::kProtocol, http2::kFlowControlError},
                      Flood{"AFrameOverItsLimit",
                            http2::Frame(http2::kData, 0, 1, std::string(16'385, 'x')), "",
                            TurnedAway::kProtocol, http2::kFrameSizeError}),
    [](const auto& instance) { return instance.param.name; });

TEST_F(HostileFrames, PrioritiesOfManyIdleStreams) {
  std::string flood;
  for (std::uint32_t i = 0; i < kFrames; ++i) flood += http2::Priority(2 * i + 1);
  ExpectCalmed(flood, TurnedAway::kPriorities);
}

TEST_F(HostileFrames, ContinuationsOfManyRequests) {
  std::string flood;
  for (std::uint32_t i = 0; i < kFrames; ++i) {
    flood += attack::HeadersWithoutEnd(2 * i + 1) +
             http2::Frame(http2::kContinuation, http2::kEndHeaders, 2 * i + 1) +
             http2::RstStream(2 * i + 1, http2::kCancel);
  }
  ExpectCalmed(flood, TurnedAway::kContinuations);
}

TEST_F(HostileFrames, Pings) {
  ExpectCalmed(http2::Times(kFrames, http2::Ping()), TurnedAway::kPings);
  EXPECT_EQ(attacker_.goaway_text(), "too_many_pings");
}

TEST_F(HostileFrames, DataOfAStreamThatThePeerResetEndsTheConnection) {
  attacker_.Send(OpenRelay(1) + http2::RstStream(1, http2::kCancel));
  ASSERT_TRUE(attacker_.Sync());
  attacker_.Send(http2::Data(1, "late"));
  ExpectEnded("", TurnedAway::kProtocol, http2::kStreamClosed);
}

TEST_F(HostileFrames, RequestsThatBreakTheRules) {
  // No more at once than may be open.
  constexpr std::uint32_t kAtOnce = 10;
  std::uint32_t sent = 0;
  while (sent < 300 && attacker_.open()) {
    std::string requests;
    for (const std::uint32_t end = sent + kAtOnce; sent < end; ++sent) {
      requests += OpenRelay(2 * sent + 1, {{"Upper-Case", "x"}});
    }
    attacker_.Send(requests);
    static_cast<void>(
        attacker_.ReadUntil([&] { return attacker_.ResetsOf(http2::kProtocolError) == sent; }));
  }
  ExpectCalmed("", TurnedAway::kResets);
  EXPECT_GT(world_.relay_probe.refused_request_total.value(), 0);
}

TEST_F(HostileFrames, PaddedDataWithContentIsNoFlood) {
  const std::string hello = HelloMessage(1);
  std::string bytes = OpenRelay(1);
  for (const char byte : hello + FaultsMessage(1, 50)) {
    bytes += PaddedData(1, std::string(1, byte), 1);
  }
  attacker_.Send(bytes);
  EXPECT_TRUE(attacker_.ReadUntil([&] { return LastAck(attacker_.At(1)).through_seq() == 50; }));
  attacker_.Send(http2::RstStream(1, http2::kCancel));
  EXPECT_EQ(TurnedAwayFor(world_, TurnedAway::kEmptyData), 0);
}

TEST_F(HostileFrames, NewKeysOfTls) {
  EXPECT_TRUE(attacker_.UpdateKeys(10));
  EXPECT_TRUE(attacker_.Sync()) << "some are within the bound";
  static_cast<void>(attacker_.UpdateKeys(kFrames));
  ExpectVictimGoesOn();
  EXPECT_TRUE(attacker_.ReadUntilEnd());
  EXPECT_TRUE(Turned(TurnedAway::kKeyUpdates));
  EXPECT_EQ(TurnedAwayFor(world_, TurnedAway::kKeyUpdates), 1);
}

TEST_F(HostileFrames, RapidResets) {
  ExpectCalmed(attack::RapidResets(1, kFrames / 2), TurnedAway::kResets);
  EXPECT_LT(world_.session_probe.streams_total.value(), 2000) << "most were never begun";
}

TEST_F(HostileFrames, AWindowOfAStreamThatOverflowsEndsTheStreamAlone) {
  attacker_.Send(OpenRelay(1) + http2::WindowUpdate(1, 0x7FFFFFFF));
  ASSERT_TRUE(attacker_.ReadUntilOver(1));
  EXPECT_EQ(attacker_.At(1).reset, http2::kFlowControlError);
  EXPECT_TRUE(attacker_.Sync());
}

TEST_F(HostileFrames, AWindowThatShrinksBelowNothing) {
  attacker_.Send(OpenRelay(1) + http2::Data(1, HelloMessage(1)));
  ASSERT_TRUE(attacker_.ReadUntil([&] { return !attacker_.At(1).data.empty(); }));
  attacker_.Send(http2::Settings({{http2::kInitialWindowSize, 0}}));
  // What was sent before the server knew is here after this.
  ASSERT_TRUE(attacker_.Sync());
  const std::size_t before = attacker_.At(1).data.size();
  for (model::Seq seq = 1; seq <= 20; ++seq) {
    ASSERT_TRUE(attacker_.Send(http2::Data(1, FaultsMessage(seq, 1))));
  }
  ExpectVictimGoesOn();
  ASSERT_TRUE(attacker_.Sync());
  EXPECT_EQ(attacker_.At(1).data.size(), before) << "the window was below nothing";
  attacker_.Send(http2::Settings({{http2::kInitialWindowSize, 0x7FFFFFFF}}));
  EXPECT_TRUE(attacker_.ReadUntil([&] { return LastAck(attacker_.At(1)).through_seq() == 20; }));
  attacker_.Send(http2::RstStream(1, http2::kCancel));
}

TEST_F(HostileFrames, HalfAFrameAndSilence) {
  ASSERT_TRUE(attacker_.Send(OpenRelay(1).substr(0, 20)));
  RawHttp2 in_the_payload(Attacker());
  ASSERT_TRUE(in_the_payload.Begin());
  in_the_payload.Send(OpenRelay(1) + http2::Data(1, std::string(1000, '\0')).substr(0, 30));
  ExpectVictimGoesOn();
}

/// What TLS wants to tell a connection that ends, by a buffer of the thread, is not told to the
/// next one: the victim would take it for a forgery, and its stream would break.
class HostileRecords : public Hostile {
 protected:
  HostileRecords() : Hostile({.queues = 1}) {}
};

TEST_F(HostileRecords, ARecordThatIsNoneDisturbsNobodyElse) {
  constexpr int kTimes = 10;
  for (int i = 0; i < kTimes; ++i) {
    RawHttp2 attacker(Attacker());
    ASSERT_TRUE(attacker.Begin());
    // A header of application data, and nothing that any key has made.
    EXPECT_TRUE(attacker.SendPlain(std::string("\x17\x03\x03\x00\x20", 5) + std::string(32, 'x')));
    EXPECT_TRUE(attacker.ReadUntilEnd());
    ExpectVictimGoesOn();
  }
}

TEST_F(HostileFrames, AGoawayOfTheClientEndsNothingByForce) {
  attacker_.Send(OpenRelay(1) + http2::Data(1, HelloMessage(1)) + http2::Goaway(0));
  EXPECT_TRUE(attacker_.ReadUntil([&] { return !attacker_.At(1).data.empty(); }));
  attacker_.Send(http2::Data(1, "", http2::kEndStream));
  EXPECT_TRUE(attacker_.ReadUntilOver(1));
  EXPECT_EQ(StatusOf(attacker_.At(1)), "0");
}

// grpc-go says its goodbye with the number of a stream of its own.
TEST_F(HostileFrames, AGoawayOfTheClientEndsNothingByForceWhateverItsNumber) {
  attacker_.Send(OpenRelay(1) + http2::Data(1, HelloMessage(1)));
  ASSERT_TRUE(attacker_.ReadUntil([&] { return !attacker_.At(1).data.empty(); }));
  for (const std::uint32_t last_stream : {1U, 2U, 0x7FFFFFFFU, 1U}) {
    attacker_.Send(http2::Goaway(http2::kNoError, last_stream));
    ASSERT_TRUE(attacker_.Sync()) << last_stream;
  }
  attacker_.Send(http2::Data(1, FaultsMessage(1, 3)));
  EXPECT_TRUE(attacker_.ReadUntil([&] { return LastAck(attacker_.At(1)).through_seq() == 3; }));
  attacker_.Send(http2::Data(1, "", http2::kEndStream));
  EXPECT_TRUE(attacker_.ReadUntilOver(1));
  EXPECT_EQ(StatusOf(attacker_.At(1)), "0");
  EXPECT_TRUE(attacker_.ReadUntilEnd()) << "with its last stream";
  EXPECT_EQ(attacker_.goaway_code().value_or(http2::kNoError), http2::kNoError);
  EXPECT_EQ(TurnedAwayFor(world_, TurnedAway::kProtocol), 0);
}

TEST_F(HostileFrames, WhoSaysGoodbyeAndLeavesWhileACallRunsIsCountedForNothing) {
  {
    RawHttp2 leaver(Attacker());
    ASSERT_TRUE(leaver.Begin());
    leaver.Send(OpenRelay(1) + http2::Data(1, HelloMessage(1)));
    ASSERT_TRUE(leaver.ReadUntil([&] { return !leaver.At(1).data.empty(); }));
    leaver.Send(http2::Goaway(http2::kNoError, 1));
  }
  EXPECT_TRUE(Eventually([this] { return world_.server().streams() == 1; }));
  for (const auto& counter : world_.relay_probe.turned_away_total) EXPECT_EQ(counter.value(), 0);
}

}  // namespace
}  // namespace uplink::testing
