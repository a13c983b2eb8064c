// Calls on a connection without TLS, on a clock that is moved by hand.
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "server/front/door/known_sources.h"
#include "tests/fuzz/front_bench.h"
#include "tests/support/http2_frames.h"
#include "tests/support/relay_bytes.h"

namespace uplink::front {
namespace {

using fuzz::FrontBench;
using fuzz::FrontWire;
using transport::MethodKind;
using namespace uplink::testing;  // NOLINT(google-build-using-namespace): what peers say

constexpr std::uint8_t kRobot = 1;

class CallTest : public ::testing::Test {
 protected:
  CallTest() { wire_.Receive(http2::Preface() + http2::Settings({})); }

  [[nodiscard]] std::int64_t EndsWith(std::string_view text) {
    std::int64_t ends = 0;
    for (std::size_t i = 0; i < session::kStreamEnds.size(); ++i) {
      if (session::kStreamEnds[i] == text) ends = bench_.session_probe().ended_total[i].value();
    }
    return ends;
  }
  /// A stream whose Welcome has come.
  void Stream(std::uint32_t stream) {
    wire_.Receive(OpenRelay(stream) + http2::Data(stream, HelloMessage(1)));
    bench_.Commit();
    ASSERT_FALSE(FramesOf(wire_.answers().At(stream)).empty());
  }
  [[nodiscard]] bool SourceIsKnown() {
    return bench_.door_book().known().IsKnown(wire_.origin().source, bench_.now());
  }

  FrontBench bench_;
  FrontWire& wire_ = bench_.Connect(kRobot);
};

TEST_F(CallTest, AResetIsCountedByWhatItMeans) {
  Stream(1);
  wire_.Receive(http2::RstStream(1, http2::kCancel));
  EXPECT_EQ(EndsWith("cancelled"), 1);
  Stream(3);
  wire_.Receive(http2::RstStream(3, http2::kEnhanceYourCalm));
  EXPECT_EQ(EndsWith("resource_exhausted"), 1);
  EXPECT_EQ(EndsWith("broken"), 0);
}

TEST_F(CallTest, AConnectionThatIsGoneBreaksItsStreams) {
  Stream(1);
  wire_.Break();
  EXPECT_EQ(EndsWith("broken"), 1);
  EXPECT_EQ(EndsWith("cancelled"), 0);
}

TEST_F(CallTest, WhatWeEndIsCountedByItsStatus) {
  Stream(1);
  // Flagged as compressed.
  wire_.Receive(http2::Data(1, Prefix(1, '\1') + "x"));
  EXPECT_EQ(StatusOf(wire_.answers().At(1)), "13");
  EXPECT_EQ(EndsWith("internal"), 1);
  EXPECT_EQ(EndsWith("broken"), 0);
}

TEST_F(CallTest, AStreamIsReportedWithWhereItCameFrom) {
  Stream(1);
  wire_.Break();
  ASSERT_EQ(bench_.connections().ended().size(), 1U);
  const storage::ConnectionItem item = bench_.connections().ended()[0];
  EXPECT_EQ(item.address, wire_.origin().text);
  EXPECT_EQ(item.robot->ruri, fuzz::RuriOf(kRobot));
}

TEST_F(CallTest, ItsReportSaysWhyItEnded) {
  Stream(1);
  wire_.Receive(http2::RstStream(1, http2::kCancel));
  Stream(3);
  // Flagged as compressed.
  wire_.Receive(http2::Data(3, Prefix(1, '\1') + "x"));
  // More than its headers announced: nghttp2 resets the stream for it.
  const std::string hello = HelloMessage(1);
  wire_.Receive(OpenRelay(5, {{"content-length", std::to_string(hello.size())}}) +
                http2::Data(5, hello));
  wire_.Receive(http2::Data(5, hello));
  Stream(7);
  wire_.Break();
  EXPECT_EQ(bench_.connections().Ends(),
            (std::vector<std::string>{"broken", "protocol_error", "protocol_error", "broken"}));
}

TEST_F(CallTest, AStreamThatDoesNotSettleBeforeItsConnectionDrainedIsDrained) {
  Stream(1);
  bench_.Drain(std::chrono::seconds(10));
  wire_.Break();
  EXPECT_EQ(bench_.connections().Ends(), std::vector<std::string>{"drained"});
}

TEST_F(CallTest, ASourceIsKnownOnceARobotStreamedFromIt) {
  wire_.Receive(OpenRelay(1));
  wire_.Receive(http2::RstStream(1, http2::kCancel));
  EXPECT_FALSE(SourceIsKnown()) << "a stream without a Hello";
  Stream(3);
  EXPECT_TRUE(SourceIsKnown());
}

TEST_F(CallTest, ASourceStaysKnownAsLongAsARobotStreamsFromIt) {
  Stream(1);
  const SteadyTime later = bench_.now() + 24 * kKnownFor;
  const auto known_later = [&] {
    return bench_.door_book().known().IsKnown(wire_.origin().source, later);
  };
  EXPECT_TRUE(known_later());
  wire_.Receive(http2::RstStream(1, http2::kCancel));
  EXPECT_FALSE(known_later());
  EXPECT_TRUE(SourceIsKnown());
}

TEST_F(CallTest, ItsConnectionEndsWithTheLastOneOnceItDrains) {
  wire_.Receive(OpenRelay(1));
  bench_.Drain(std::chrono::seconds(10));
  EXPECT_TRUE(wire_.open());
  wire_.Receive(http2::RstStream(1, http2::kCancel));
  EXPECT_FALSE(wire_.open());
  EXPECT_EQ(wire_.answers().goaways().back().code, 0U);
}

TEST_F(CallTest, ADrainTellsTheStreamsOfAConnectionOneAfterTheOther) {
  constexpr std::uint32_t kStreams = transport::kStreamsPerCertificateMax;
  for (std::uint32_t i = 0; i < kStreams; ++i) wire_.Receive(OpenRelay(2 * i + 1));
  // Some are told within this tick of the timers, some within the next.
  bench_.Pass(transport::kTimerTick / 2);
  bench_.Drain(std::chrono::seconds(10));
  const auto told = [&] {
    std::uint32_t ended = 0;
    for (std::uint32_t i = 0; i < kStreams; ++i) {
      // Without a Hello it ends as soon as it is told.
      if (StatusOf(wire_.answers().At(2 * i + 1)) == "14") ++ended;
    }
    return ended;
  };
  EXPECT_EQ(told(), 0U);
  bench_.Pass(transport::kTimerTick / 2);
  EXPECT_GT(told(), 0U);
  EXPECT_LT(told(), kStreams);
  bench_.Pass(transport::kTimerTick);
  EXPECT_EQ(told(), kStreams);
}

// --- Methods of other kinds than the relay's ---

/// Answers the one message that it takes, so many times.
class Echo final : public transport::CallHandler {
 public:
  Echo(transport::ServedCall& call, int answers) : call_(call), left_(answers) {}

  void Start() override { call_.RequestMessage(); }
  [[nodiscard]] std::uint64_t message_bytes_max() const override { return 1000; }
  void OnMessage(std::string_view bytes) override {
    answer_ = WithPrefix(bytes);
    call_.RequestMessage();
  }
  void OnTooLarge(std::uint64_t /*bytes*/) override { call_.Cancel(); }
  void OnHalfClose() override { Answer(); }
  void OnBroken(const transport::Ending& /*ending*/) override {}
  void OnWritten() override { Answer(); }
  void OnWake() override {}
  void OnTimer() override {}
  [[nodiscard]] std::optional<SteadyTime> deadline() const override { return std::nullopt; }
  void OnDrain(milliseconds /*grace*/) override {}

 private:
  void Answer() {
    if (left_-- > 0) return call_.Write(answer_);
    call_.Finish(absl::OkStatus());
  }

  transport::ServedCall& call_;
  int left_;
  std::string answer_;
};

transport::Methods Echoes(MethodKind kind, int answers) {
  transport::Methods methods;
  methods.emplace("/e.E/Echo",
                  transport::Method{.kind = kind,
                                    .roles = {identity::Role::kRobot},
                                    .audience = "robots alone",
                                    .serve = [answers](transport::ServedCall& call)
                                        -> absl::StatusOr<std::unique_ptr<transport::CallHandler>> {
                                      return std::make_unique<Echo>(call, answers);
                                    }});
  return methods;
}

/// What a call of such a method gets that sends these bytes and half-closes.
RawStream AnswerOf(MethodKind kind, int answers, const std::string& sent) {
  FrontBench bench(Echoes(kind, answers));
  FrontWire& wire = bench.Connect(kRobot);
  wire.Receive(http2::Preface() + http2::Settings({}) + OpenRelay(1, {{":path", "/e.E/Echo"}}) +
               http2::Data(1, sent, http2::kEndStream));
  return wire.answers().At(1);
}

TEST(MethodKinds, AUnaryCallHasOneMessageAndOneAnswer) {
  const RawStream stream = AnswerOf(MethodKind::kUnary, 1, WithPrefix("x"));
  EXPECT_EQ(StatusOf(stream), "0");
  EXPECT_EQ(stream.data, WithPrefix("x"));
}

TEST(MethodKinds, AServerStreamHasOneMessageAndManyAnswers) {
  const RawStream stream = AnswerOf(MethodKind::kServerStream, 3, WithPrefix("x"));
  EXPECT_EQ(StatusOf(stream), "0");
  EXPECT_EQ(stream.data, WithPrefix("x") + WithPrefix("x") + WithPrefix("x"));
}

TEST(MethodKinds, NoMessageOrTwoAreInternal) {
  for (const MethodKind kind : {MethodKind::kUnary, MethodKind::kServerStream}) {
    EXPECT_EQ(StatusOf(AnswerOf(kind, 1, "")), "13");
    EXPECT_EQ(StatusOf(AnswerOf(kind, 1, WithPrefix("x") + WithPrefix("y"))), "13");
  }
}

TEST(MethodKinds, AMethodSaysHowItsCallsEndAtTheirDeadline) {
  transport::Methods methods = Echoes(MethodKind::kUnary, 1);
  methods.at("/e.E/Echo").at_deadline = absl::UnavailableError("not in time");
  FrontBench bench(std::move(methods));
  FrontWire& wire = bench.Connect(kRobot);
  wire.Receive(http2::Preface() + http2::Settings({}) +
               OpenRelay(1, {{":path", "/e.E/Echo"}, {"grpc-timeout", "50m"}}));
  bench.Pass(milliseconds(200));
  EXPECT_EQ(StatusOf(wire.answers().At(1)), "14");
}

TEST(MethodKinds, ACallThatWasAnsweredGivesItsPlacesBack) {
  FrontBench bench(Echoes(MethodKind::kUnary, 1));
  FrontWire& wire = bench.Connect(kRobot);
  wire.Receive(http2::Preface() + http2::Settings({}) + OpenRelay(1, {{":path", "/e.E/Echo"}}) +
               http2::Data(1, WithPrefix("x"), http2::kEndStream));
  EXPECT_TRUE(bench.door_book().known().IsKnown(wire.origin().source, bench.now()));
  EXPECT_FALSE(bench.door_book().known().IsKnown(wire.origin().source, bench.now() + 2 * kKnownFor))
      << "it has ended";
}

TEST(MethodKinds, AMethodIsToldOfEachCallsEndOnce) {
  using Ends = std::vector<std::optional<absl::StatusCode>>;
  Ends ends;
  transport::Methods methods = Echoes(MethodKind::kUnary, 1);
  methods.at("/e.E/Echo").ended = [&ends](auto code) { ends.push_back(code); };
  FrontBench bench(std::move(methods));
  FrontWire& wire = bench.Connect(kRobot);
  wire.Receive(http2::Preface() + http2::Settings({}));
  const auto open = [&wire](std::uint32_t stream) {
    wire.Receive(OpenRelay(stream, {{":path", "/e.E/Echo"}}));
  };
  open(1);
  wire.Receive(http2::Data(1, WithPrefix("x"), http2::kEndStream));
  open(3);
  wire.Receive(http2::Data(3, "", http2::kEndStream));
  open(5);
  wire.Receive(http2::RstStream(5, http2::kCancel));
  open(7);
  wire.Break();
  EXPECT_EQ(ends,
            (Ends{absl::StatusCode::kOk, absl::StatusCode::kInternal, std::nullopt, std::nullopt}));
}

TEST(MethodKindsDeathTest, TwoAnswersOfAUnaryCallAreABug) {
  EXPECT_DEATH(AnswerOf(MethodKind::kUnary, 2, WithPrefix("x")), "one answer");
}

}  // namespace
}  // namespace uplink::front
