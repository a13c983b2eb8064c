// What the gate for certificates needs of OpenSSL: its callback gets a message once the message is
// whole and before OpenSSL reads it, and OpenSSL reads it at the address that the callback got.
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

#include <gtest/gtest.h>
#include <openssl/bio.h>
#include <openssl/err.h>
#include <openssl/ssl.h>

#include "server/identity/pem.h"
#include "tests/support/memory_tls.h"
#include "tests/support/openssl_owners.h"

namespace uplink::identity {
namespace {

using testing::MemoryTls;

/// A server of OpenSSL's alone, whose callback spoils the client's Certificate message, or does
/// not.
class OpenSslMessages : public ::testing::TestWithParam<int> {
 protected:
  enum class Spoils : std::uint8_t { kYes, kNo };
  struct Seen {
    Spoils spoils = Spoils::kNo;
    int certificates = 0;
    int verified = 0;
  };

  static void OnMessage(int written, int /*version*/, int type, const void* bytes, std::size_t size,
                        SSL* /*ssl*/, void* argument) {
    const auto* message = static_cast<const std::uint8_t*>(bytes);
    if (written != 0 || type != SSL3_RT_HANDSHAKE || message[0] != SSL3_MT_CERTIFICATE) return;
    auto& seen = *static_cast<Seen*>(argument);
    ++seen.certificates;
    if (seen.spoils == Spoils::kNo) return;
    auto* own = static_cast<std::uint8_t*>(const_cast<void*>(bytes));
    for (std::size_t at = 4; at < size; ++at) own[at] = 0xFF;
  }
  static int OnVerify(X509_STORE_CTX* /*store*/, void* seen) {
    ++static_cast<Seen*>(seen)->verified;
    return 1;
  }

  /// A handshake with a client that shows its certificate; whether the server finished it.
  bool Handshake(Spoils spoils) {
    seen_ = {.spoils = spoils};
    const testing::SslContext context(SSL_CTX_new(TLS_server_method()));
    EXPECT_TRUE(UseChain(context.get(), server_.certificate));
    EXPECT_TRUE(UseKey(context.get(), server_.key));
    SSL_CTX_set_max_proto_version(context.get(), GetParam());
    SSL_CTX_set_verify(context.get(), SSL_VERIFY_PEER | SSL_VERIFY_FAIL_IF_NO_PEER_CERT, nullptr);
    SSL_CTX_set_cert_verify_callback(context.get(), OnVerify, &seen_);
    const testing::Ssl ssl(SSL_new(context.get()));
    BIO* in = BIO_new(BIO_s_mem());
    BIO* out = BIO_new(BIO_s_mem());
    SSL_set_bio(ssl.get(), in, out);
    SSL_set_accept_state(ssl.get());
    SSL_set_msg_callback(ssl.get(), OnMessage);
    SSL_set_msg_callback_arg(ssl.get(), &seen_);
    MemoryTls client({.identity = client_, .behind = nullptr, .version_max = GetParam()});
    std::string said;
    int result = 0;
    do {
      const std::string heard = client.Step(said);
      BIO_write(in, heard.data(), static_cast<int>(heard.size()));
      result = SSL_do_handshake(ssl.get());
      said.assign(BIO_ctrl_pending(out), '\0');
      if (!said.empty()) BIO_read(out, said.data(), static_cast<int>(said.size()));
    } while (result != 1 && SSL_get_error(ssl.get(), result) == SSL_ERROR_WANT_READ);
    has_peer_ = SSL_get0_peer_certificate(ssl.get()) != nullptr;
    ERR_clear_error();
    return result == 1;
  }

  const testing::TestAuthority authority_;
  const testing::KeyPair server_ = authority_.Issue(testing::ServerSpec());
  const testing::KeyPair client_ = authority_.Issue(testing::RobotSpec("rcan://x.local/robots/1"));
  Seen seen_;
  bool has_peer_ = false;
};

TEST_P(OpenSslMessages, ASpoiledMessageIsReadAsItIsThen) {
  EXPECT_FALSE(Handshake(Spoils::kYes));
  EXPECT_EQ(seen_.certificates, 1);
  EXPECT_EQ(seen_.verified, 0) << "it was read as it came";
  EXPECT_FALSE(has_peer_);
}

TEST_P(OpenSslMessages, OneThatIsLeftAsItIsIsTaken) {
  EXPECT_TRUE(Handshake(Spoils::kNo));
  EXPECT_EQ(seen_.certificates, 1);
  EXPECT_EQ(seen_.verified, 1);
  EXPECT_TRUE(has_peer_);
}

INSTANTIATE_TEST_SUITE_P(Versions, OpenSslMessages,
                         ::testing::Values(TLS1_2_VERSION, TLS1_3_VERSION));

}  // namespace
}  // namespace uplink::identity
