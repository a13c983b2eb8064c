// Who may speak to the relay, over real handshakes.
#include <cstdint>
#include <memory>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <openssl/bio.h>
#include <openssl/err.h>

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
  EXPECT_EQ(EndOf(world.Channel(foreign.Issue(spec))).error_code(), grpc::StatusCode::UNAVAILABLE);
  EXPECT_EQ(world.session_probe.streams_total.value(), 0);
  EXPECT_EQ(world.relay_probe.refused_identity_total.value(), 0);
}

}  // namespace
}  // namespace uplink::testing
