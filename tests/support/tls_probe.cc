#include "tests/support/tls_probe.h"

#include <memory>

#include <openssl/bio.h>
#include <openssl/err.h>
#include <openssl/ssl.h>

#include "tests/support/openssl_owners.h"

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

}  // namespace

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

}  // namespace uplink::testing
