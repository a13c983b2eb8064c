#include "server/loop/client_hello.h"

#include <memory>

#include <openssl/bio.h>
#include <openssl/ssl.h>

namespace uplink::loop {
namespace {

struct FreeContext {
  void operator()(SSL_CTX* context) const { SSL_CTX_free(context); }
};
struct FreeSsl {
  void operator()(SSL* ssl) const { SSL_free(ssl); }
};

// RFC 8446, sections 5.1 and 4.
constexpr char kHandshakeRecord = 22;
constexpr char kTlsMajorVersion = 3;
constexpr char kServerHelloMessage = 2;

}  // namespace

std::string MakeClientHello() {
  const std::unique_ptr<SSL_CTX, FreeContext> context(SSL_CTX_new(TLS_client_method()));
  if (context == nullptr) return {};
  const std::unique_ptr<SSL, FreeSsl> ssl(SSL_new(context.get()));
  if (ssl == nullptr) return {};
  constexpr unsigned char kHttp2[] = {2, 'h', '2'};
  SSL_set_alpn_protos(ssl.get(), kHttp2, sizeof(kHttp2));
  BIO* const in = BIO_new(BIO_s_mem());
  BIO* const out = BIO_new(BIO_s_mem());
  SSL_set_bio(ssl.get(), in, out);  // takes both
  if (in == nullptr || out == nullptr) return {};
  SSL_set_connect_state(ssl.get());
  SSL_do_handshake(ssl.get());  // writes the hello, then wants an answer that it never gets
  std::string hello(BIO_ctrl_pending(out), '\0');
  const int bytes = BIO_read(out, hello.data(), static_cast<int>(hello.size()));
  if (bytes <= 0) return {};
  hello.resize(static_cast<std::size_t>(bytes));
  return hello;
}

bool IsServerHello(std::string_view answer) {
  return answer.size() >= kServerHelloPrefix && answer[0] == kHandshakeRecord &&
         answer[1] == kTlsMajorVersion && answer[5] == kServerHelloMessage;
}

}  // namespace uplink::loop
