#include "tests/support/memory_tls.h"

#include <cstddef>

#include <openssl/bio.h>
#include <openssl/err.h>
#include <openssl/ssl.h>

#include "schema/base/check.h"
#include "server/identity/pem.h"
#include "tests/support/openssl_owners.h"

namespace uplink::testing {
namespace {

void SawMessage(int is_sent, int /*version*/, int type, const void* bytes, std::size_t size,
                SSL* /*ssl*/, void* alert) {
  if (is_sent == 1 || type != SSL3_RT_ALERT || size < 2) return;
  *static_cast<std::optional<int>*>(alert) = static_cast<const unsigned char*>(bytes)[1];
}

}  // namespace

struct MemoryTls::Tls {
  SslContext context{SSL_CTX_new(TLS_client_method())};
  Ssl ssl;
  /// Both are the ssl's.
  BIO* in = BIO_new(BIO_s_mem());
  BIO* out = BIO_new(BIO_s_mem());
};

MemoryTls::MemoryTls(const Options& options) : tls_(std::make_unique<Tls>()) {
  SSL_CTX* context = tls_->context.get();
  SSL_CTX_set_max_proto_version(context, options.version_max);
  if (!options.groups.empty()) {
    UPLINK_CHECK(SSL_CTX_set1_groups_list(context, options.groups.c_str()) == 1, options.groups);
  }
  if (!options.signatures.empty()) {
    UPLINK_CHECK(SSL_CTX_set1_sigalgs_list(context, options.signatures.c_str()) == 1,
                 options.signatures);
  }
  if (!options.suites_of_12.empty()) {
    UPLINK_CHECK(SSL_CTX_set_cipher_list(context, options.suites_of_12.c_str()) == 1,
                 options.suites_of_12);
  }
  if (!options.identity.certificate.empty()) {
    // A stranger may show what the library advises against.
    SSL_CTX_set_security_level(context, 1);
    UPLINK_CHECK(identity::UseChain(context, options.identity.certificate) &&
                     identity::UseKey(context, options.identity.key),
                 "a key pair of the test's own");
  }
  if (options.padded_bytes > 0) {
    UPLINK_CHECK(SSL_CTX_set_block_padding(context, options.padded_bytes) == 1, "a record's size");
  }
  if (options.behind != nullptr) options.behind->AddTo(context);
  tls_->ssl.reset(SSL_new(context));
  SSL* ssl = tls_->ssl.get();
  SSL_set_alpn_protos(ssl, reinterpret_cast<const unsigned char*>(options.protocols.data()),
                      static_cast<unsigned int>(options.protocols.size()));
  SSL_set_bio(ssl, tls_->in, tls_->out);
  SSL_set_connect_state(ssl);
  if (options.shows_later) SSL_set_post_handshake_auth(ssl, 1);
  SSL_set_msg_callback(ssl, SawMessage);
  SSL_set_msg_callback_arg(ssl, &alert_);
}

MemoryTls::~MemoryTls() = default;

std::string MemoryTls::Step(std::string_view from_server) {
  if (!from_server.empty()) {
    BIO_write(tls_->in, from_server.data(), static_cast<int>(from_server.size()));
  }
  if (!done_) {
    done_ = SSL_do_handshake(tls_->ssl.get()) == 1;
  } else {
    char byte = 0;
    static_cast<void>(SSL_read(tls_->ssl.get(), &byte, 1));
  }
  ERR_clear_error();
  return TakeSaid();
}

std::string MemoryTls::Say(std::string_view plain) {
  SSL_write(tls_->ssl.get(), plain.data(), static_cast<int>(plain.size()));
  ERR_clear_error();
  return TakeSaid();
}

std::string MemoryTls::RenewKeys() {
  UPLINK_CHECK(SSL_key_update(tls_->ssl.get(), SSL_KEY_UPDATE_NOT_REQUESTED) == 1, "TLS 1.3");
  SSL_do_handshake(tls_->ssl.get());
  ERR_clear_error();
  return TakeSaid();
}

std::string MemoryTls::Renegotiate() {
  UPLINK_CHECK(SSL_renegotiate(tls_->ssl.get()) == 1, "TLS 1.2");
  SSL_do_handshake(tls_->ssl.get());
  ERR_clear_error();
  return TakeSaid();
}

std::string MemoryTls::TakeSaid() {
  std::string said(BIO_ctrl_pending(tls_->out), '\0');
  if (!said.empty()) BIO_read(tls_->out, said.data(), static_cast<int>(said.size()));
  return said;
}

}  // namespace uplink::testing
