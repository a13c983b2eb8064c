// Streams of several robots on one gateway's connection, against the real relay.
#include "tools/link/http2_link.h"

#include <chrono>
#include <csignal>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/relay_world.h"
#include "tools/link/grpc_connection.h"

namespace uplink::link {
namespace {

using testing::RelayWorld;

/// One robot behind the gateway.
class Part final : public StreamEvents {
 public:
  Part(const std::shared_ptr<Http2Link>& link, int robot)
      : robot_(robot),
        connection_(std::make_unique<GrpcConnection>(link, "localhost",
                                                     static_cast<StreamEvents&>(*this))) {
    connection_->Connect();
  }
  void OnConnected() override {
    ASSERT_TRUE(connection_->OpenStream("/uplink.v1.UplinkRelay/Relay"));
    v1::RelayRequest hello = testing::HelloFrame(testing::SessionOf(1));
    hello.mutable_hello()->set_robot_ruri(testing::RuriOf(robot_));
    connection_->Send(hello.SerializeAsString());
  }
  void OnMessage(std::string_view message) override {
    v1::RelayResponse frame;
    ASSERT_TRUE(frame.ParseFromArray(message.data(), static_cast<int>(message.size())));
    if (frame.has_welcome()) welcomed = true;
    if (frame.has_ack()) acked = frame.ack().through_seq();
  }
  void OnSent() override {}
  void OnEnded(const StreamEnd& how) override { end = how; }

  void Send(model::Seq seq) {
    connection_->Send(testing::BatchFrame({{seq, testing::FaultPayload("a")}}).SerializeAsString());
  }
  [[nodiscard]] GrpcConnection& connection() { return *connection_; }
  void Drop() { connection_.reset(); }

  bool welcomed = false;
  model::Seq acked = 0;
  std::optional<StreamEnd> end;

 private:
  const int robot_;
  std::unique_ptr<GrpcConnection> connection_;
};

class Http2LinkTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { std::signal(SIGPIPE, SIG_IGN); }

  std::shared_ptr<Http2Link> NewLink() {
    testing::CertificateSpec spec;
    spec.units = {"gateway"};
    const testing::KeyPair pair = world_.authority.Issue(spec);
    LinkOptions options;
    options.address = *Resolve("localhost:" + std::to_string(world_.port()));
    options.identity = *Identity::Parse(pair.certificate, pair.key);
    options.tls = *TlsClient::Create(world_.authority.certificate(), Alpn::kHttp2);
    return std::make_shared<Http2Link>(loop_, std::move(options), Http2Link::For::kSeveral);
  }
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

  RelayWorld world_;
  Loop loop_;
};

TEST_F(Http2LinkTest, StreamsShareOneConnection) {
  const auto link = NewLink();
  Part first(link, 1);
  Part second(link, 2);
  ASSERT_TRUE(Until([&] { return first.welcomed && second.welcomed; }));
  Part third(link, 3);
  ASSERT_TRUE(Until([&] { return third.welcomed; })) << "one that joins later";
  for (Part* part : {&first, &second, &third}) part->Send(1);
  EXPECT_TRUE(Until([&] { return first.acked == 1 && second.acked == 1 && third.acked == 1; }));
  second.connection().HalfClose();
  ASSERT_TRUE(Until([&] { return second.end.has_value(); }));
  EXPECT_EQ(second.end->code, kCodeOk);
  EXPECT_FALSE(first.end);
}

TEST_F(Http2LinkTest, APartThatIsDroppedLeavesTheOthers) {
  const auto link = NewLink();
  Part first(link, 1);
  Part second(link, 2);
  ASSERT_TRUE(Until([&] { return first.welcomed && second.welcomed; }));
  first.Drop();
  second.Send(1);
  EXPECT_TRUE(Until([&] { return second.acked == 1 && world_.server().streams() == 1; }));
}

TEST_F(Http2LinkTest, ACutEndsAllItsStreamsAndTellsTheOthers) {
  const auto link = NewLink();
  Part first(link, 1);
  Part second(link, 2);
  ASSERT_TRUE(Until([&] { return first.welcomed && second.welcomed; }));
  first.connection().Cut();
  EXPECT_TRUE(link->over());
  EXPECT_FALSE(second.end) << "not from within a call";
  ASSERT_TRUE(Until([&] { return second.end.has_value(); }));
  EXPECT_EQ(second.end->code, kCodeUnavailable);
  EXPECT_FALSE(first.end) << "it knows";
  EXPECT_TRUE(Until([&] { return world_.server().streams() == 0; }));
}

TEST_F(Http2LinkTest, AStreamThatIsNotReadHoldsUpNoOther) {
  const auto link = NewLink();
  Part slow(link, 1);
  Part quick(link, 2);
  ASSERT_TRUE(Until([&] { return slow.welcomed && quick.welcomed; }));
  slow.connection().PauseReading(true);
  slow.Send(1);
  quick.Send(1);
  ASSERT_TRUE(Until([&] { return quick.acked == 1; }));
  ASSERT_TRUE(Until([&] {
    return world_.database.Log(testing::RuriOf(1), testing::SessionOf(1)).stored.size() == 1;
  }));
  quick.Send(2);
  ASSERT_TRUE(Until([&] { return quick.acked == 2; }));
  EXPECT_EQ(slow.acked, 0U);
  slow.connection().PauseReading(false);
  EXPECT_TRUE(Until([&] { return slow.acked == 1; }));
}

}  // namespace
}  // namespace uplink::link
