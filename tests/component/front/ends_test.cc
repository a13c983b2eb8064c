// Why streams end, as their connections are reported: real sockets and TLS, and a clock that is
// moved by hand.
#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/front/lifetime.h"
#include "tests/component/front/connection_bench.h"
#include "tests/support/eventually.h"
#include "tests/support/relay_bytes.h"

namespace uplink::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr milliseconds kMoment{20};
constexpr std::chrono::seconds kStep{20};

/// A robot that streams.
class Ends : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(robot_->Begin());
    robot_->Send(OpenRelay(1) + http2::Data(1, HelloMessage(1)));
    ASSERT_TRUE(robot_->Sync());
    bench_.Commit();
    ASSERT_TRUE(robot_->ReadUntil([&] { return !FramesOf(robot_->At(1)).empty(); }));
    ASSERT_THAT(connections().begun(), SizeIs(1));
    ASSERT_THAT(connections().ended(), IsEmpty());
  }
  [[nodiscard]] const KeptConnections& connections() { return bench_.bench().connections(); }
  [[nodiscard]] std::vector<std::string> EndsSoon() {
    EXPECT_TRUE(Eventually([this] { return !connections().ended().empty(); }));
    return connections().Ends();
  }

  ConnectionBench bench_;
  const KeyPair keys_ = bench_.authority().Issue(RobotSpec(fuzz::RuriOf(1)));
  std::unique_ptr<RawHttp2> robot_ = std::make_unique<RawHttp2>(bench_.Client(keys_));
};

TEST_F(Ends, TheCertificateIsThatOfTheHandshake) {
  const storage::CertificateFacts facts = connections().begun()[0].certificate;
  EXPECT_FALSE(facts.serial.empty());
  EXPECT_EQ(facts.serial.find_first_not_of("0123456789ABCDEF"), std::string::npos);
  EXPECT_EQ(facts.sha256.size(), 64U);
  EXPECT_EQ(facts.key_sha256.size(), 64U);
  EXPECT_NE(facts.sha256, facts.key_sha256);
  ASSERT_TRUE(facts.not_after);
  EXPECT_GT(*facts.not_after, SystemClock{}.System());
}

TEST_F(Ends, ACutConnectionIsBroken) {
  robot_.reset();
  EXPECT_THAT(EndsSoon(), ElementsAre("broken"));
}

TEST_F(Ends, AnEndOfTlsWithoutAHalfCloseIsBroken) {
  ASSERT_TRUE(robot_->EndTls());
  EXPECT_THAT(EndsSoon(), ElementsAre("broken"));
}

TEST_F(Ends, AHalfCloseIsOrderly) {
  robot_->Send(http2::Data(1, "", http2::kEndStream));
  EXPECT_THAT(EndsSoon(), ElementsAre("orderly"));
}

TEST_F(Ends, AnUnansweredPingIsSilent) {
  bench_.Pass(front::kKeepaliveAfter + kMoment);
  bench_.Pass(front::kKeepaliveWait + kMoment);
  EXPECT_THAT(EndsSoon(), ElementsAre("silent"));
  EXPECT_EQ(connections().ended()[0].ended->detail, "nothing answered the server's keepalive");
}

TEST_F(Ends, ABrokenRuleOfHttpTwoIsAProtocolError) {
  robot_->Send("this is no frame of HTTP/2, and far too long for one");
  EXPECT_THAT(EndsSoon(), ElementsAre("protocol_error"));
}

TEST_F(Ends, ABadFrameIsAProtocolError) {
  robot_->Send(http2::Data(1, WithPrefix("\xff\xff")));
  EXPECT_THAT(EndsSoon(), ElementsAre("protocol_error"));
}

TEST_F(Ends, ANewerStreamReplacesIt) {
  RawHttp2 second(bench_.Client(keys_));
  ASSERT_TRUE(second.Begin());
  second.Send(OpenRelay(1) + http2::Data(1, HelloMessage(1)));
  ASSERT_TRUE(second.Sync());
  bench_.Commit();
  EXPECT_THAT(EndsSoon(), ElementsAre("replaced"));
}

TEST_F(Ends, TheEndOfItsCertificateIsNoDrain) {
  const SystemTime not_after = *connections().begun()[0].certificate.not_after;
  bench_.Do([&] { bench_.bench().clock().SetSystem(not_after); });
  // A look at the certificate comes each minute, and something must be heard meanwhile.
  for (milliseconds passed{0}; passed <= front::kExpiryLook + 2 * kStep; passed += kStep) {
    bench_.Pass(kStep);
    if (!robot_->Sync()) break;
  }
  bench_.Commit();
  EXPECT_THAT(EndsSoon(), ElementsAre("certificate_expired"));
}

TEST(EndOfTheServer, IsItsEnd) {
  std::vector<std::string> ends;
  {
    ConnectionBench bench;
    RawHttp2 robot(bench.Client(bench.authority().Issue(RobotSpec(fuzz::RuriOf(1)))));
    ASSERT_TRUE(robot.Begin());
    robot.Send(OpenRelay(1) + http2::Data(1, HelloMessage(1)));
    ASSERT_TRUE(robot.Sync());
    bench.ShutDown();
    ends = bench.bench().connections().Ends();
  }
  EXPECT_THAT(ends, ElementsAre("server_ended"));
}

}  // namespace
}  // namespace uplink::testing
