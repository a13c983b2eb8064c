// Who may speak to the relay, over real handshakes.
#include <memory>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/relay_world.h"

namespace uplink::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

grpc::Status EndOf(const std::shared_ptr<grpc::Channel>& channel) {
  TestAgent agent(channel);
  EXPECT_FALSE(agent.Connect(SessionOf(1)));
  return agent.End();
}

// Every flaw of a name has its sentence in tests/unit/server/identity/peer_identity_test.cc.
TEST(Certificates, OneWithoutANameIsUnauthenticatedWithItsSentence) {
  CertificateSpec spec = RobotSpec(RuriOf(1), "acme");
  spec.uris.clear();
  RelayWorld world;
  const grpc::Status status = EndOf(world.Channel(world.authority.Issue(spec)));
  EXPECT_EQ(status.error_code(), grpc::StatusCode::UNAUTHENTICATED);
  EXPECT_THAT(
      status.error_message(),
      StartsWith("client certificate: it is a robot's and has no URI name that begins rcan://"));
  EXPECT_EQ(world.relay_probe.refused_identity_total.value(), 1);
}

TEST(Certificates, RobotMayNotSpeakForAnother) {
  RelayWorld world;
  TestAgent agent(world.Channel(RuriOf(1)));
  v1::RelayRequest hello = HelloFrame(SessionOf(1));
  hello.mutable_hello()->set_robot_ruri(RuriOf(2));
  agent.Send(hello);
  const grpc::Status status = agent.End();
  EXPECT_EQ(status.error_code(), grpc::StatusCode::PERMISSION_DENIED);
  EXPECT_THAT(status.error_message(), HasSubstr(RuriOf(2)));
}

/// Two flaws at once; OpenSSL finds one first, and neither hides the other's refusal.
TEST(Certificates, ExpiredCertificateOfAServerIsNotServed) {
  CertificateSpec spec = RobotSpec(RuriOf(1));
  spec.not_after_s = -60;
  spec.key_usages = {"serverAuth"};
  RelayWorld world;
  EXPECT_FALSE(EndOf(world.Channel(world.authority.Issue(spec))).ok());
  EXPECT_EQ(world.session_probe.streams_total.value(), 0);
}

/// An expired certificate of an authority that is not ours is a stranger's.
TEST(Certificates, ExpiredForeignCertificateFailsTheHandshake) {
  RelayWorld world;
  const TestAuthority foreign("test authority");
  CertificateSpec spec = RobotSpec(RuriOf(1));
  spec.not_after_s = -60;
  EXPECT_EQ(EndOf(world.Channel(foreign.Issue(spec))).error_code(), grpc::StatusCode::UNAVAILABLE);
  EXPECT_EQ(world.session_probe.streams_total.value(), 0);
  EXPECT_EQ(world.relay_probe.refused_identity_total.value(), 0);
}

}  // namespace
}  // namespace uplink::testing
