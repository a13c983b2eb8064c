// The gate on a connection whose context was made without a thought of it: one call is enough.
#include "server/identity/certificate_messages.h"

#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <openssl/bio.h>
#include <openssl/err.h>
#include <openssl/ssl.h>

#include "server/identity/pem.h"
#include "tests/support/memory_tls.h"
#include "tests/support/odd_certificates.h"
#include "tests/support/openssl_owners.h"

namespace uplink::identity {
namespace {

namespace odd = testing::odd;
using testing::MemoryTls;
using testing::ShownChain;
using testing::Ssl;
using testing::SslContext;

/// One end of a connection without a socket, by OpenSSL's defaults, with the gate.
struct End {
  explicit End(SSL_CTX* context) : ssl(SSL_new(context)) { SSL_set_bio(ssl.get(), in, out); }

  /// What it says to that.
  std::string Hear(std::string_view said) {
    if (!said.empty()) BIO_write(in, said.data(), static_cast<int>(said.size()));
    char byte = 0;
    result = done ? SSL_read(ssl.get(), &byte, 1) : SSL_do_handshake(ssl.get());
    done = done || result == 1;
    failed = result != 1 && SSL_get_error(ssl.get(), result) != SSL_ERROR_WANT_READ;
    if (failed) messages.NoteFailure(ERR_peek_error());
    ERR_clear_error();
    return TakeOutput();
  }
  std::string TakeOutput() const {
    std::string said(BIO_ctrl_pending(out), '\0');
    if (!said.empty()) BIO_read(out, said.data(), static_cast<int>(said.size()));
    return said;
  }

  BIO* const in = BIO_new(BIO_s_mem());
  BIO* const out = BIO_new(BIO_s_mem());
  Ssl ssl;
  CertificateMessages messages{ssl.get()};
  int result = 0;
  bool done = false;
  bool failed = false;
};

class CertificateMessagesTest : public ::testing::TestWithParam<int> {
 protected:
  static int AcceptAny(X509_STORE_CTX* /*store*/, void* /*argument*/) { return 1; }

  [[nodiscard]] SslContext ContextOf(const SSL_METHOD* method) const {
    SslContext context(SSL_CTX_new(method));
    EXPECT_TRUE(UseChain(context.get(), server_.certificate));
    EXPECT_TRUE(UseKey(context.get(), server_.key));
    SSL_CTX_set_max_proto_version(context.get(), GetParam());
    SSL_CTX_set_verify(context.get(), SSL_VERIFY_PEER, nullptr);
    SSL_CTX_set_cert_verify_callback(context.get(), AcceptAny, nullptr);
    return context;
  }
  [[nodiscard]] MemoryTls::Options Client() const {
    return {.identity = client_, .behind = nullptr, .version_max = GetParam()};
  }
  static void Meet(End& server, MemoryTls& client) {
    std::string said;
    for (int i = 0; i < 10 && !server.failed && !(server.done && client.done()); ++i) {
      said = server.Hear(client.Step(said));
    }
    // Its tickets.
    static_cast<void>(client.Step(said));
  }
  /// What a server thinks of a client that shows this behind its certificate.
  CertificateFlaw FlawBehind(const std::vector<std::string>& behind) {
    const SslContext context = ContextOf(TLS_server_method());
    End server(context.get());
    SSL_set_accept_state(server.ssl.get());
    MemoryTls::Options options = Client();
    options.behind = std::make_shared<ShownChain>(behind);
    MemoryTls client(options);
    Meet(server, client);
    EXPECT_EQ(server.done, server.messages.flaw() == CertificateFlaw::kNone);
    EXPECT_EQ(SSL_get0_peer_certificate(server.ssl.get()) != nullptr, server.done);
    return server.messages.flaw();
  }

  const testing::TestAuthority authority_;
  const testing::KeyPair server_ = authority_.Issue(testing::ServerSpec());
  const testing::KeyPair client_ = authority_.Issue(testing::RobotSpec("rcan://x.local/robots/1"));
};

TEST_P(CertificateMessagesTest, AServerJudgesItsClients) {
  const std::string other = odd::CertificateWith(odd::Ed25519Key());
  using Chain = std::vector<std::string>;
  EXPECT_EQ(FlawBehind(Chain(kShownCertificatesMax - 1, other)), CertificateFlaw::kNone);
  EXPECT_EQ(FlawBehind(Chain(kShownCertificatesMax, other)), CertificateFlaw::kCount);
  EXPECT_EQ(FlawBehind({odd::CertificateWith(odd::ExplicitCurveKey())}), CertificateFlaw::kKeyKind);
  EXPECT_EQ(FlawBehind({odd::CertificateWith(odd::RsaKey(4097, 17))}), CertificateFlaw::kKeySize);
}

TEST_P(CertificateMessagesTest, WhatIsLongerThanAMessageMayBeIsNotRead) {
  odd::Parts parts;
  parts.key = odd::Ed25519Key();
  parts.extensions = odd::Extension("\x2A", std::string(kShownBytesMax, 'x'));
  EXPECT_EQ(FlawBehind({odd::CertificateOf(parts)}), CertificateFlaw::kBytes);
}

TEST_P(CertificateMessagesTest, AClientJudgesItsServer) {
  for (const bool odd_one : {false, true}) {
    const SslContext server_context = ContextOf(TLS_server_method());
    SSL_CTX_set_verify(server_context.get(), SSL_VERIFY_NONE, nullptr);
    if (odd_one) {
      ShownChain({odd::CertificateWith(odd::ExplicitCurveKey())}).AddTo(server_context.get());
    }
    const SslContext client_context = ContextOf(TLS_client_method());
    End server(server_context.get());
    SSL_set_accept_state(server.ssl.get());
    End client(client_context.get());
    SSL_set_connect_state(client.ssl.get());
    std::string said;
    for (int i = 0; i < 5 && !client.failed && !client.done; ++i) {
      said = server.Hear(client.Hear(said));
    }
    EXPECT_EQ(client.done, !odd_one);
    EXPECT_EQ(client.messages.flaw(), odd_one ? CertificateFlaw::kKeyKind : CertificateFlaw::kNone);
  }
}

INSTANTIATE_TEST_SUITE_P(Versions, CertificateMessagesTest,
                         ::testing::Values(TLS1_2_VERSION, TLS1_3_VERSION));

// --- After the handshake ---

class LaterMessages13 : public CertificateMessagesTest {};
class LaterMessages12 : public CertificateMessagesTest {};

// The server asks for no certificate later. If one is asked for, the answer is judged too: it has
// a context, and none is taken.
TEST_P(LaterMessages13, ACertificateThatComesAfterTheHandshakeIsJudged) {
  const SslContext context = ContextOf(TLS_server_method());
  SSL_CTX_set_verify(context.get(), SSL_VERIFY_PEER | SSL_VERIFY_POST_HANDSHAKE, nullptr);
  End server(context.get());
  SSL_set_accept_state(server.ssl.get());
  MemoryTls::Options options = Client();
  options.shows_later = true;
  MemoryTls client(options);
  Meet(server, client);
  ASSERT_TRUE(server.done);
  EXPECT_EQ(SSL_get0_peer_certificate(server.ssl.get()), nullptr);
  ASSERT_EQ(SSL_verify_client_post_handshake(server.ssl.get()), 1);
  SSL_do_handshake(server.ssl.get());
  static_cast<void>(server.Hear(client.Step(server.TakeOutput())));
  EXPECT_TRUE(server.failed);
  EXPECT_EQ(server.messages.flaw(), CertificateFlaw::kMalformed);
  EXPECT_EQ(SSL_get0_peer_certificate(server.ssl.get()), nullptr);
}

INSTANTIATE_TEST_SUITE_P(Version, LaterMessages13, ::testing::Values(TLS1_3_VERSION));

TEST_P(LaterMessages12, NobodyBeginsASecondHandshake) {
  const SslContext context = ContextOf(TLS_server_method());
  End server(context.get());
  SSL_set_accept_state(server.ssl.get());
  MemoryTls client(Client());
  Meet(server, client);
  ASSERT_TRUE(server.done);
  static_cast<void>(server.messages.TakeCount());
  static_cast<void>(client.Step(server.Hear(client.Renegotiate())));
  EXPECT_EQ(client.alert(), SSL_AD_NO_RENEGOTIATION);
  EXPECT_FALSE(server.failed);
  EXPECT_EQ(server.messages.TakeCount(), 1U) << "a peer that asks again and again is found out";
}

INSTANTIATE_TEST_SUITE_P(Version, LaterMessages12, ::testing::Values(TLS1_2_VERSION));

}  // namespace
}  // namespace uplink::identity
