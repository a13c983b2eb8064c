// The synthetic fleet's client by the gRPC library, against the real relay.
#include "tools/link/library_connection.h"

#include <chrono>
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

constexpr const char* kMethod = "/uplink.v1.UplinkRelay/Relay";

class LibraryConnectionTest : public ::testing::Test, public StreamEvents {
 protected:
  void OnConnected() override { opened_ = connection_->OpenStream(kMethod); }
  void OnMessage(std::string_view message) override {
    v1::RelayResponse& frame = frames_.emplace_back();
    ASSERT_TRUE(frame.ParseFromArray(message.data(), static_cast<int>(message.size())));
  }
  void OnSent() override { ++sent_; }
  void OnEnded(const StreamEnd& end) override { end_ = end; }

  void Dial(const testing::KeyPair& pair) {
    connection_ = std::make_unique<LibraryConnection>(
        loop_,
        DialOptions{.target = "localhost:" + std::to_string(world_.port()),
                    .server_ca = world_.authority.certificate(),
                    .certificate = pair.certificate,
                    .key = pair.key},
        *this);
    opened_ = false;
    connection_->Connect();
    ASSERT_TRUE(Until([this] { return opened_; }));
  }
  void Send(const v1::RelayRequest& frame) { connection_->Send(frame.SerializeAsString()); }

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
  bool Welcomed(std::uint8_t session = 1) {
    frames_.clear();
    end_.reset();
    Send(testing::HelloFrame(testing::SessionOf(session)));
    return Until([this] { return !frames_.empty() || end_; }) && !frames_.empty() &&
           frames_.front().has_welcome();
  }
  bool Connects() {
    Dial(Robot());
    return Welcomed();
  }
  bool Ended() {
    return Until([this] { return end_.has_value(); });
  }
  bool Acked(model::Seq through) {
    return Until([&] { return !frames_.empty() && frames_.back().ack().through_seq() >= through; });
  }
  testing::KeyPair Robot() {
    return world_.authority.Issue(testing::RobotSpec(testing::RuriOf(1)));
  }
  std::size_t Stored() {
    return world_.database.Log(testing::RuriOf(1), testing::SessionOf(1)).stored.size();
  }

  testing::RelayWorld world_;
  Loop loop_;
  std::unique_ptr<LibraryConnection> connection_;
  bool opened_ = false;
  std::vector<v1::RelayResponse> frames_;
  int sent_ = 0;
  std::optional<StreamEnd> end_;
};

TEST_F(LibraryConnectionTest, AMessageIsAckedAndTheStreamEndsOk) {
  ASSERT_TRUE(Connects());
  Send(testing::BatchFrame({{1, testing::FaultPayload("a")}}));
  ASSERT_TRUE(Acked(1));
  EXPECT_EQ(Stored(), 1U);
  EXPECT_GT(sent_, 0);
  // That the library is done with it may come after the answer to it.
  EXPECT_TRUE(Until([this] { return connection_->unsent() == 0; }));
  connection_->HalfClose();
  ASSERT_TRUE(Ended());
  EXPECT_EQ(end_->code, kCodeOk) << end_->message;
}

TEST_F(LibraryConnectionTest, TheServersWordsComeWithTheEnd) {
  Dial(Robot());
  Send(testing::BatchFrame({{1, testing::FaultPayload("a")}}));
  ASSERT_TRUE(Ended());
  EXPECT_EQ(end_->code, kCodeInvalidArgument);
  EXPECT_THAT(end_->message, HasSubstr("the first frame must be a hello"));
}

TEST_F(LibraryConnectionTest, ACancelledStreamLeavesTheConnectionForAnother) {
  ASSERT_TRUE(Connects());
  connection_->CancelStream();
  EXPECT_FALSE(end_.has_value()) << "not from within a call";
  ASSERT_TRUE(Ended());
  EXPECT_EQ(end_->code, kCodeCancelled);
  ASSERT_TRUE(connection_->usable());
  ASSERT_TRUE(connection_->OpenStream(kMethod));
  EXPECT_FALSE(connection_->OpenStream(kMethod)) << "one stream at a time";
  ASSERT_TRUE(Welcomed(2));
}

TEST_F(LibraryConnectionTest, APausedReaderReadsLater) {
  ASSERT_TRUE(Connects());
  connection_->PauseReading(true);
  Send(testing::BatchFrame({{1, testing::FaultPayload("a")}}));
  ASSERT_TRUE(Until([this] { return Stored() == 1; }));
  connection_->PauseReading(false);
  EXPECT_TRUE(Acked(1));
}

TEST_F(LibraryConnectionTest, AStreamThatIsCancelledWhilePausedEnds) {
  ASSERT_TRUE(Connects());
  connection_->PauseReading(true);
  const std::size_t before = frames_.size();
  Send(testing::BatchFrame({{1, testing::FaultPayload("a")}}));
  // The frame that was asked for before comes; no other is asked for.
  ASSERT_TRUE(Until([&] { return frames_.size() > before; }));
  connection_->CancelStream();
  ASSERT_TRUE(Ended());
  EXPECT_EQ(end_->code, kCodeCancelled);
}

TEST_F(LibraryConnectionTest, AConnectionThatGoesEndsItsStreamAndSaysNothing) {
  ASSERT_TRUE(Connects());
  connection_.reset();
  EXPECT_TRUE(testing::Eventually([this] { return world_.session_probe.streams.value() == 0; }));
  loop_.io.restart();
  loop_.io.run();
  EXPECT_FALSE(end_.has_value());
}

TEST_F(LibraryConnectionTest, ACutConnectionSaysNothingAndTheServerForgetsIt) {
  ASSERT_TRUE(Connects());
  connection_->Cut();
  EXPECT_FALSE(connection_->usable());
  EXPECT_TRUE(Until([this] { return world_.session_probe.streams.value() == 0; }));
  EXPECT_FALSE(end_.has_value());
}

TEST_F(LibraryConnectionTest, AFrozenConnectionIsTakenOver) {
  ASSERT_TRUE(Connects());
  connection_->Freeze();
  Send(testing::BatchFrame({{1, testing::FaultPayload("lost")}}));
  const auto frozen = std::move(connection_);
  ASSERT_TRUE(Connects());
  Send(testing::BatchFrame({{1, testing::FaultPayload("a")}}));
  ASSERT_TRUE(Acked(1));
  EXPECT_EQ(Stored(), 1U);
}

TEST_F(LibraryConnectionTest, ARobotOfAnotherAuthorityGetsNoStream) {
  const testing::TestAuthority other("other");
  Dial(other.Issue(testing::RobotSpec(testing::RuriOf(1))));
  ASSERT_TRUE(Ended());
  EXPECT_EQ(end_->code, kCodeUnavailable);
  EXPECT_FALSE(connection_->usable());
}

}  // namespace
}  // namespace uplink::link
