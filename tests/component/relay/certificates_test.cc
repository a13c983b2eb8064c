// Who may speak to the relay, over real handshakes.
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <openssl/ssl.h>

#include "tests/support/relay_world.h"
#include "tests/support/tls_probe.h"

namespace uplink::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

grpc::Status EndOf(const std::shared_ptr<grpc::Channel>& channel) {
  TestAgent agent(channel);
  EXPECT_FALSE(agent.Connect(SessionOf(1)));
  return agent.End();
}

struct WrongCertificate {
  const char* name;
  CertificateSpec spec;
  const char* sentence;
};

std::vector<WrongCertificate> WrongCertificates() {
  const CertificateSpec robot = RobotSpec(RuriOf(1), "acme");
  std::vector<WrongCertificate> all;
  const auto add = [&](const char* name, const char* sentence, auto change) {
    CertificateSpec spec = robot;
    change(spec);
    all.push_back({name, spec, sentence});
  };
  add("NoUri", "has no URI name that begins rcan://", [](auto& spec) { spec.uris.clear(); });
  add("TwoUris", "has 2 rcan:// URIs instead of one",
      [](auto& spec) { spec.uris.push_back(RuriOf(2)); });
  add("LongUri", "has 257 bytes, the limit is 256",
      [](auto& spec) { spec.uris = {"rcan://" + std::string(250, 'x')}; });
  add("TwinUri", "is a twin's, and twins are heard through their broker alone", [](auto& spec) {
    spec.uris = {"rcan://local.rcan/cyberwave/twin/3f2504e0-4f89-11d3-9a0c-0305e82c3301"};
  });
  add("GatewayWithATwinsUri", "cyberwave/sim.site/T is a twin's", [](auto& spec) {
    spec.units = {"gateway"};
    spec.uris.push_back("rcan://local.rcan/cyberwave/sim.site/T");
  });
  add("UncleanUri", "white space", [](auto& spec) { spec.uris = {"rcan://a b"}; });
  add("NoKeyUsage", "has no extended key usage clientAuth",
      [](auto& spec) { spec.key_usages.clear(); });
  add("UnknownUnit", "its OU is pilot, which is no role",
      [](auto& spec) { spec.units = {"pilot"}; });
  add("TwoUnits", "more than one OU", [](auto& spec) { spec.units = {"robot", "robot"}; });
  add("TwoFleets", "more than one O", [](auto& spec) { spec.organizations = {"a", "b"}; });
  add("AllFleets", "its O is *", [](auto& spec) { spec.organizations = {"*"}; });
  add("NulInFleet", "holds a NUL byte",
      [](auto& spec) { spec.organizations = {std::string("a\0b", 3)}; });
  add("OperatorWithUri", "its OU is operator and it has an rcan:// URI",
      [](auto& spec) { spec.units = {"operator"}; });
  return all;
}

class WrongCertificateTest : public ::testing::TestWithParam<WrongCertificate> {};

TEST_P(WrongCertificateTest, IsUnauthenticatedWithItsSentence) {
  RelayWorld world;
  const grpc::Status status = EndOf(world.Channel(world.authority.Issue(GetParam().spec)));
  EXPECT_EQ(status.error_code(), grpc::StatusCode::UNAUTHENTICATED);
  EXPECT_THAT(status.error_message(), StartsWith("client certificate: "));
  EXPECT_THAT(status.error_message(), HasSubstr(GetParam().sentence));
  EXPECT_EQ(world.relay_probe.refused_identity_total.value(), 1);
}

INSTANTIATE_TEST_SUITE_P(All, WrongCertificateTest, ::testing::ValuesIn(WrongCertificates()),
                         [](const auto& instance) { return instance.param.name; });

TEST(Certificates, RobotIsWelcomedByItsRuri) {
  RelayWorld world;
  TestAgent agent(world.Channel(RuriOf(7)));
  const auto welcome = agent.Connect(SessionOf(1));
  ASSERT_TRUE(welcome);
  EXPECT_EQ(welcome->robot_ruri(), RuriOf(7));
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

TEST(Certificates, OperatorIsNoRobot) {
  RelayWorld world;
  CertificateSpec spec;
  spec.units = {"viewer"};
  const grpc::Status status = EndOf(world.Channel(world.authority.Issue(spec)));
  EXPECT_EQ(status.error_code(), grpc::StatusCode::UNAUTHENTICATED);
  EXPECT_THAT(status.error_message(), HasSubstr("role viewer"));
}

/// Expects that no call reached the server.
void ExpectNoHandshake(RelayWorld& world, const std::shared_ptr<grpc::Channel>& channel) {
  EXPECT_EQ(EndOf(channel).error_code(), grpc::StatusCode::UNAVAILABLE);
  EXPECT_EQ(world.session_probe.streams_total.value(), 0);
  EXPECT_EQ(world.relay_probe.refused_identity_total.value(), 0);
}

/// The chain is one of our authority's, and may not be used: the agent is told why.
void ExpectNotServed(const CertificateSpec& spec, const char* sentence) {
  RelayWorld world;
  const grpc::Status status = EndOf(world.Channel(world.authority.Issue(spec)));
  EXPECT_EQ(status.error_code(), grpc::StatusCode::UNAUTHENTICATED);
  EXPECT_EQ(status.error_message(), std::string("client certificate: ") + sentence);
  EXPECT_EQ(world.session_probe.streams_total.value(), 0);
  EXPECT_EQ(world.relay_probe.refused_identity_total.value(), 1);
}

TEST(Certificates, ForeignAuthorityFailsTheHandshake) {
  RelayWorld world;
  const TestAuthority foreign("test authority");  // the name is no proof
  ExpectNoHandshake(world, world.Channel(foreign.Issue(RobotSpec(RuriOf(1)))));
}

TEST(Certificates, ExpiredCertificateIsNotServed) {
  CertificateSpec spec = RobotSpec(RuriOf(1));
  spec.not_after_s = -60;
  ExpectNotServed(spec, "it, or one that signed it, has expired");
}

TEST(Certificates, CertificateOfTheFutureIsNotServed) {
  CertificateSpec spec = RobotSpec(RuriOf(1));
  spec.not_before_s = 600;
  ExpectNotServed(spec, "it, or one that signed it, is not valid yet");
}

TEST(Certificates, CertificateOfAServerIsNotServed) {
  CertificateSpec spec = RobotSpec(RuriOf(1));
  spec.key_usages = {"serverAuth"};
  ExpectNotServed(spec, "its key usage or extended key usage lacks what a client needs");
}

/// Two flaws at once, of which OpenSSL finds one first: neither hides the other's refusal.
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
  ExpectNoHandshake(world, world.Channel(foreign.Issue(spec)));
}

TEST(Certificates, NoCertificateFailsTheHandshake) {
  RelayWorld world;
  ExpectNoHandshake(world, world.Channel(KeyPair{}));
}

TEST(Certificates, PlaintextIsRefused) {
  RelayWorld world;
  ExpectNoHandshake(
      world,
      MakeChannel(
          {.port = world.server().port(), .server_ca = "", .identity = {}, .lookahead_bytes = 0}));
}

TEST(Certificates, Tls12IsServedWhereItIsTheLeast) {
  RelayWorld::Options options;
  options.tls.minimum = config::TlsVersion::k12;
  RelayWorld world(options);
  EXPECT_EQ(AgreedTlsVersion(world.server().port(), TLS1_2_VERSION), "TLSv1.2");
  EXPECT_EQ(AgreedTlsVersion(world.server().port(), TLS1_1_VERSION), "");
}

}  // namespace
}  // namespace uplink::testing
