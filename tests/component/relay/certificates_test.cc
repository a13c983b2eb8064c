// Who may speak to the relay, over real handshakes.
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <openssl/bio.h>
#include <openssl/err.h>
#include <openssl/ssl.h>

#include "tests/support/openssl_owners.h"
#include "tests/support/relay_world.h"

namespace uplink::testing {
namespace {

/// Remembers that a ServerHello came: it holds the version, whatever becomes of the handshake.
void SawMessage(int is_sent, int /*version*/, int content_type, const void* bytes, std::size_t size,
                SSL* /*ssl*/, void* seen) {
  if (is_sent == 1 || content_type != SSL3_RT_HANDSHAKE || size == 0) return;
  if (*static_cast<const unsigned char*>(bytes) == SSL3_MT_SERVER_HELLO) {
    *static_cast<bool*>(seen) = true;
  }
}

/// Begins a TLS handshake with a listener on loopback, offering at most `version_max`, without a
/// client certificate. Returns the version of the ServerHello (`TLSv1.2`); empty if none came: the
/// server refused what was offered.
std::string AgreedTlsVersion(std::uint16_t port, int version_max) {
  const SslContext context(SSL_CTX_new(TLS_client_method()));
  SSL_CTX_set_max_proto_version(context.get(), version_max);
  const std::unique_ptr<BIO, FreeWith<BIO_free_all>> bio(BIO_new_ssl_connect(context.get()));
  SSL* ssl = nullptr;
  BIO_get_ssl(bio.get(), &ssl);
  bool seen = false;
  SSL_set_msg_callback(ssl, SawMessage);
  SSL_set_msg_callback_arg(ssl, &seen);
  // gRPC takes no connection that does not speak HTTP/2.
  constexpr unsigned char kProtocols[] = {2, 'h', '2'};
  SSL_set_alpn_protos(ssl, kProtocols, sizeof(kProtocols));
  BIO_set_conn_hostname(bio.get(), ("127.0.0.1:" + std::to_string(port)).c_str());
  BIO_do_handshake(bio.get());
  ERR_clear_error();
  return seen ? SSL_get_version(ssl) : "";
}

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
