#include "server/front/tls/tls_context.h"

#include <utility>

#include <openssl/err.h>
#include <openssl/ssl.h>

#include "server/front/tls/tls_engine.h"
#include "server/identity/pem.h"
#include "server/transport/key_files.h"
#include "server/transport/tls_settings.h"

namespace uplink::front {
namespace {

/// HTTP/2 in ALPN's form: its length, its name.
constexpr unsigned char kHttp2[] = {2, 'h', '2'};

int ChooseProtocol(SSL* /*ssl*/, const unsigned char** chosen, unsigned char* chosen_size,
                   const unsigned char* offered, unsigned int offered_size, void* /*argument*/) {
  unsigned char* found = nullptr;
  if (SSL_select_next_proto(&found, chosen_size, kHttp2, sizeof kHttp2, offered, offered_size) !=
      OPENSSL_NPN_NEGOTIATED) {
    return SSL_TLSEXT_ERR_ALERT_FATAL;
  }
  *chosen = found;
  return SSL_TLSEXT_ERR_OK;
}

void SetHandshake(SSL_CTX* context, const transport::TlsRules& rules) {
  SSL_CTX_set_client_hello_cb(context, TlsEngine::OnClientHello, nullptr);
  SSL_CTX_set_alpn_select_cb(context, ChooseProtocol, nullptr);
  const int required = rules.certificate_required ? SSL_VERIFY_FAIL_IF_NO_PEER_CERT : 0;
  SSL_CTX_set_verify(context, SSL_VERIFY_PEER | required, TlsEngine::OnVerified);
}

}  // namespace

absl::StatusOr<std::shared_ptr<const TlsContext>> TlsContext::Make(
    const transport::PemTexts& texts, const transport::TlsRules& rules) {
  if (absl::Status good = transport::CheckTexts(texts); !good.ok()) return good;
  auto trusted =
      identity::TrustedAuthorities::Of({"the client authority", texts.client_ca}, texts.rules);
  if (!trusted.ok()) return trusted.status();
  SSL_CTX* context = SSL_CTX_new(TLS_server_method());
  if (context == nullptr) return absl::InternalError("OpenSSL: no context");
  std::shared_ptr<const TlsContext> made(new TlsContext(context, rules, *std::move(trusted)));
  SetHandshake(context, rules);
  if (!transport::SetProtocol(context, rules)) {
    ERR_clear_error();
    return absl::InternalError("OpenSSL: none of the suites or groups");
  }
  if (!identity::UseChain(context, texts.certificate) || !identity::UseKey(context, texts.key) ||
      !transport::TrustAuthorities(context, texts.client_ca)) {
    ERR_clear_error();
    return absl::FailedPreconditionError("OpenSSL does not take certificate, key or authority");
  }
  ERR_clear_error();
  return made;
}

TlsContext::~TlsContext() { SSL_CTX_free(context_); }

}  // namespace uplink::front
