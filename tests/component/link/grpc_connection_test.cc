#include "tools/link/grpc_connection.h"

#include <chrono>
#include <csignal>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/relay_world.h"

namespace uplink::link {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using testing::RelayWorld;

constexpr const char* kMethod = "/uplink.v1.UplinkRelay/Relay";

/// Keeps what a connection says, and opens a stream as soon as it can.
class Caller final : public StreamEvents {
 public:
  Caller(Loop& loop, LinkOptions options, bool open = true)
      : loop_(loop), open_(open), connection_(loop, std::move(options), *this) {
    connection_.Connect();
  }

  void OnConnected() override {
    connected = true;
    if (open_) connection_.OpenStream(kMethod);
  }
  void OnMessage(std::string_view message) override {
    v1::RelayResponse& frame = frames.emplace_back();
    ASSERT_TRUE(frame.ParseFromArray(message.data(), static_cast<int>(message.size())));
  }
  void OnSent() override { ++sent; }
  void OnEnded(const StreamEnd& how) override { end = how; }

  void Send(const v1::RelayRequest& frame) { connection_.Send(frame.SerializeAsString()); }
  GrpcConnection& connection() { return connection_; }

  /// Runs the loop until it holds; false once patience ends.
  template <typename Condition>
  bool Until(const Condition& condition) {
    const SteadyTime deadline = SystemClock{}.Steady() + testing::kPatience;
    while (!condition()) {
      if (SystemClock{}.Steady() > deadline) return false;
      loop_.io.restart();
      loop_.io.run_one_for(std::chrono::milliseconds(50));
    }
    return true;
  }
  bool Connect(std::uint8_t session = 1) {
    if (!Until([this] { return connected || end; }) || end) return false;
    Send(testing::HelloFrame(testing::SessionOf(session)));
    return Until([this] { return !frames.empty() || end; }) && !frames.empty() &&
           frames.front().has_welcome();
  }
  bool UntilAcked(model::Seq through) {
    return Until([&] { return !frames.empty() && frames.back().ack().through_seq() >= through; });
  }

  bool connected = false;
  std::vector<v1::RelayResponse> frames;
  int sent = 0;
  std::optional<StreamEnd> end;

 private:
  Loop& loop_;
  bool open_;
  GrpcConnection connection_;
};

class GrpcConnectionTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { std::signal(SIGPIPE, SIG_IGN); }

  LinkOptions OptionsFor(const testing::KeyPair& pair, const std::string& host = "localhost") {
    LinkOptions options;
    options.address = *Resolve(host + ":" + std::to_string(world_.SpecFor("").port));
    options.identity = *Identity::Parse(pair.certificate, pair.key);
    options.tls = *TlsClient::Create(world_.authority.certificate(), Alpn::kHttp2);
    return options;
  }
  LinkOptions OptionsFor(int robot) {
    return OptionsFor(world_.authority.Issue(testing::RobotSpec(testing::RuriOf(robot))));
  }
  std::vector<model::Seq> Stored() {
    return world_.database.Log(testing::RuriOf(1), testing::SessionOf(1)).stored;
  }

  RelayWorld world_;
  Loop loop_;
};

TEST_F(GrpcConnectionTest, AMessageIsAckedAndTheStreamEndsOk) {
  Caller caller(loop_, OptionsFor(1));
  ASSERT_TRUE(caller.Connect());
  caller.Send(testing::BatchFrame({{1, testing::FaultPayload("a")}}));
  ASSERT_TRUE(caller.UntilAcked(1));
  EXPECT_EQ(Stored().size(), 1U);
  caller.connection().HalfClose();
  ASSERT_TRUE(caller.Until([&] { return caller.end.has_value(); }));
  EXPECT_EQ(caller.end->code, kCodeOk) << caller.end->message;
}

TEST_F(GrpcConnectionTest, TheServersWordsComeWithTheEnd) {
  Caller caller(loop_, OptionsFor(1));
  ASSERT_TRUE(caller.Connect());
  caller.connection().Send("this is no frame");
  ASSERT_TRUE(caller.Until([&] { return caller.end.has_value(); }));
  EXPECT_EQ(caller.end->code, kCodeInvalidArgument);
  EXPECT_THAT(caller.end->message, Not(IsEmpty()));
  EXPECT_THAT(caller.end->message, Not(HasSubstr("%20")));
}

TEST_F(GrpcConnectionTest, ACancelledStreamLeavesTheConnectionForAnother) {
  Caller caller(loop_, OptionsFor(1));
  ASSERT_TRUE(caller.Connect());
  caller.connection().CancelStream();
  EXPECT_FALSE(caller.end.has_value()) << "not from within a call";
  ASSERT_TRUE(caller.Until([&] { return caller.end.has_value(); }));
  EXPECT_EQ(caller.end->code, kCodeCancelled);
  ASSERT_TRUE(caller.connection().usable());
  caller.frames.clear();
  caller.end.reset();
  ASSERT_TRUE(caller.connection().OpenStream(kMethod));
  ASSERT_TRUE(caller.Connect());
  caller.Send(testing::BatchFrame({{1, testing::FaultPayload("a")}}));
  EXPECT_TRUE(caller.UntilAcked(1));
}

TEST_F(GrpcConnectionTest, AFrameBeyondEveryWindowArrivesWhole) {
  Caller caller(loop_, OptionsFor(1));
  ASSERT_TRUE(caller.Connect());
  std::vector<testing::Sent> messages;
  constexpr model::Seq kMessages = 200;
  for (model::Seq seq = 1; seq <= kMessages; ++seq) {
    messages.push_back({seq, testing::FaultPayload(std::string(60, 'f') + std::to_string(seq))});
  }
  model::Seq sent = 0;
  while (sent < 2 * kMessages) {
    caller.Send(testing::BatchFrame(messages));
    for (testing::Sent& each : messages) sent = each.seq, each.seq += kMessages;
  }
  EXPECT_GT(caller.connection().unsent(), 0U);
  ASSERT_TRUE(caller.UntilAcked(sent));
  EXPECT_EQ(caller.connection().unsent(), 0U);
  EXPECT_EQ(Stored().size(), sent);
}

TEST_F(GrpcConnectionTest, AnUnknownMethodIsUnimplemented) {
  Caller caller(loop_, OptionsFor(1), false);
  ASSERT_TRUE(caller.Until([&] { return caller.connected; }));
  ASSERT_TRUE(caller.connection().OpenStream("/uplink.v1.UplinkRelay/Nothing"));
  EXPECT_FALSE(caller.connection().OpenStream(kMethod)) << "one stream at a time";
  ASSERT_TRUE(caller.Until([&] { return caller.end.has_value(); }));
  EXPECT_EQ(caller.end->code, kCodeUnimplemented);
}

TEST_F(GrpcConnectionTest, ARobotOfAnotherAuthorityGetsNoStream) {
  const testing::TestAuthority other("other");
  Caller caller(loop_, OptionsFor(other.Issue(testing::RobotSpec(testing::RuriOf(1)))));
  EXPECT_FALSE(caller.Connect());
  ASSERT_TRUE(caller.Until([&] { return caller.end.has_value(); }));
  EXPECT_EQ(caller.end->code, kCodeUnavailable);
}

TEST_F(GrpcConnectionTest, AServerOfAnotherNameOrAuthorityIsRefused) {
  LinkOptions options = OptionsFor(1);
  options.address.host = "other.example";
  Caller caller(loop_, options);
  ASSERT_TRUE(caller.Until([&] { return caller.end.has_value(); }));
  EXPECT_THAT(caller.end->message, HasSubstr("certificate verify failed"));
  EXPECT_FALSE(caller.connected);

  options = OptionsFor(1);
  options.tls = *TlsClient::Create(testing::TestAuthority("other").certificate(), Alpn::kHttp2);
  Caller second(loop_, options);
  ASSERT_TRUE(second.Until([&] { return second.end.has_value(); }));
  EXPECT_THAT(second.end->message, HasSubstr("certificate verify failed"));
}

TEST_F(GrpcConnectionTest, AnAddressIsANameInACertificateToo) {
  Caller caller(loop_, OptionsFor(world_.authority.Issue(testing::RobotSpec(testing::RuriOf(1))),
                                  "127.0.0.1"));
  EXPECT_TRUE(caller.Connect());
}

TEST_F(GrpcConnectionTest, WhereNothingListensTheEndSaysSo) {
  const LinkOptions options = OptionsFor(1);
  world_.StopServer();
  Caller caller(loop_, options);
  ASSERT_TRUE(caller.Until([&] { return caller.end.has_value(); }));
  EXPECT_EQ(caller.end->code, kCodeUnavailable);
  EXPECT_THAT(caller.end->message, HasSubstr("refused"));
}

TEST_F(GrpcConnectionTest, AServerThatStopsEndsTheStream) {
  Caller caller(loop_, OptionsFor(1));
  ASSERT_TRUE(caller.Connect());
  world_.StopServer();
  ASSERT_TRUE(caller.Until([&] { return caller.end.has_value(); }));
  EXPECT_EQ(caller.end->code, kCodeUnavailable);
}

TEST_F(GrpcConnectionTest, APausedReaderReadsLater) {
  Caller caller(loop_, OptionsFor(1));
  ASSERT_TRUE(caller.Connect());
  caller.connection().PauseReading(true);
  const std::size_t before = caller.frames.size();
  caller.Send(testing::BatchFrame({{1, testing::FaultPayload("a")}}));
  // The ack is on its way from the store's answer on.
  ASSERT_TRUE(caller.Until([&] { return Stored().size() == 1; }));
  EXPECT_EQ(caller.frames.size(), before);
  caller.connection().PauseReading(false);
  EXPECT_TRUE(caller.UntilAcked(1));
}

TEST_F(GrpcConnectionTest, ASlowNetworkHoldsBytesBack) {
  LinkOptions options = OptionsFor(1);
  options.delay = milliseconds(20);
  Caller caller(loop_, options);
  ASSERT_TRUE(caller.Until([&] { return caller.connected; }));
  EXPECT_GT(caller.connection().unsent(), 0U);
  ASSERT_TRUE(caller.Connect());
  EXPECT_TRUE(caller.Until([&] { return caller.connection().unsent() == 0; }));
  EXPECT_GT(caller.sent, 0);
}

TEST_F(GrpcConnectionTest, ACutConnectionSaysNothingAndTheServerForgetsIt) {
  Caller caller(loop_, OptionsFor(1));
  ASSERT_TRUE(caller.Connect());
  caller.connection().Cut();
  EXPECT_TRUE(testing::Eventually([&] { return world_.session_probe.streams.value() == 0; }));
  caller.Until([&] { return loop_.io.stopped(); });
  EXPECT_FALSE(caller.end.has_value());
}

TEST_F(GrpcConnectionTest, AFrozenConnectionIsTakenOver) {
  Caller frozen(loop_, OptionsFor(1));
  ASSERT_TRUE(frozen.Connect());
  frozen.connection().Freeze();
  frozen.Send(testing::BatchFrame({{1, testing::FaultPayload("lost")}}));
  Caller next(loop_, OptionsFor(1));
  ASSERT_TRUE(next.Connect());
  next.Send(testing::BatchFrame({{1, testing::FaultPayload("a")}}));
  ASSERT_TRUE(next.UntilAcked(1));
  EXPECT_EQ(Stored().size(), 1U);
  EXPECT_FALSE(frozen.end.has_value());
}

TEST(IdentityTest, WrongPemIsSaid) {
  const testing::TestAuthority authority;
  const testing::KeyPair one = authority.Issue(testing::RobotSpec(testing::RuriOf(1)));
  const testing::KeyPair two = authority.Issue(testing::RobotSpec(testing::RuriOf(2)));
  EXPECT_TRUE(Identity::Parse(one.certificate, one.key).ok());
  EXPECT_EQ(Identity::Parse(one.certificate, two.key).status().code(),
            absl::StatusCode::kInvalidArgument);
  EXPECT_FALSE(Identity::Parse("x", one.key).ok());
  EXPECT_FALSE(TlsClient::Create("x", Alpn::kHttp2).ok());
}

TEST(ResolveTest, FormsOfAddresses) {
  EXPECT_EQ(Resolve("127.0.0.1:7443")->host, "127.0.0.1");
  EXPECT_EQ(Resolve("[::1]:7443")->host, "::1");
  EXPECT_EQ(Resolve("[::1]:7443")->endpoints.front().port(), 7443);
  EXPECT_EQ(Resolve("localhost").status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(Resolve(":1").status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(Resolve("no-such-host.invalid:1").status().code(), absl::StatusCode::kUnavailable);
}

}  // namespace
}  // namespace uplink::link
