#include "server/front/tls/tls_context.h"

#include <string>
#include <string_view>

#include <openssl/err.h>
#include <openssl/ssl.h>

#include "server/front/tls/tls_engine.h"
#include "server/identity/certificate_gate.h"
#include "server/identity/pem.h"
#include "server/transport/key_files.h"

namespace uplink::front {
namespace {

/// HTTP/2 in ALPN's form: its length, its name.
constexpr unsigned char kHttp2[] = {2, 'h', '2'};
/// The suites of TLS 1.2 that HTTP/2 allows. Suites with CBC, or without a key of its own for each
/// connection, are left out.
constexpr char kSuitesOf12[] = "ECDHE+AESGCM:ECDHE+CHACHA20";
/// Intermediate certificates between a robot and an authority.
constexpr int kChainDepthMax = 8;
// OpenSSL's depth counts neither the robot's certificate nor the authority's, and a robot may show
// both: so the longest verified chain may be shown completely.
static_assert(kChainDepthMax + 2 <= int{identity::kShownCertificatesMax});

bool TrustAuthorities(SSL_CTX* context, std::string_view text) {
  const auto authorities = identity::ReadCertificates({"", std::string(text)});
  if (!authorities.ok()) return false;
  X509_STORE* store = SSL_CTX_get_cert_store(context);
  // The authority that signs robots may itself be signed by another.
  X509_STORE_set_flags(store, X509_V_FLAG_PARTIAL_CHAIN | X509_V_FLAG_TRUSTED_FIRST);
  for (const identity::Certificate& next : *authorities) {
    if (X509_STORE_add_cert(store, next.get()) != 1) return false;
    // Tells clients with several certificates which one to send.
    if (SSL_CTX_add_client_CA(context, next.get()) != 1) return false;
  }
  return true;
}

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

/// False if the library has none of the suites or groups.
bool SetProtocol(SSL_CTX* context, const transport::TlsRules& rules) {
  SSL_CTX_set_min_proto_version(
      context, rules.minimum == config::TlsVersion::k13 ? TLS1_3_VERSION : TLS1_2_VERSION);
  SSL_CTX_set_options(context,
                      SSL_OP_NO_TICKET | SSL_OP_NO_COMPRESSION | SSL_OP_CIPHER_SERVER_PREFERENCE);
  SSL_CTX_set_num_tickets(context, 0);
  SSL_CTX_set_session_cache_mode(context, SSL_SESS_CACHE_OFF);
  // An idle connection gives its buffers back: 34 of some 60 KiB (measured).
  SSL_CTX_set_mode(context, SSL_MODE_RELEASE_BUFFERS | SSL_MODE_ENABLE_PARTIAL_WRITE |
                                SSL_MODE_ACCEPT_MOVING_WRITE_BUFFER);
  SSL_CTX_set_client_hello_cb(context, TlsEngine::OnClientHello, nullptr);
  SSL_CTX_set_alpn_select_cb(context, ChooseProtocol, nullptr);
  SSL_CTX_set_verify(context, SSL_VERIFY_PEER | SSL_VERIFY_FAIL_IF_NO_PEER_CERT,
                     TlsEngine::OnVerified);
  SSL_CTX_set_verify_depth(context, kChainDepthMax);
  return SSL_CTX_set_cipher_list(context, kSuitesOf12) == 1 &&
         SSL_CTX_set1_groups_list(context, rules.groups.c_str()) == 1;
}

}  // namespace

absl::StatusOr<std::shared_ptr<const TlsContext>> TlsContext::Make(
    const transport::PemTexts& texts, const transport::TlsRules& rules) {
  if (absl::Status good = transport::CheckTexts(texts); !good.ok()) return good;
  SSL_CTX* context = SSL_CTX_new(TLS_server_method());
  if (context == nullptr) return absl::InternalError("OpenSSL: no context");
  std::shared_ptr<const TlsContext> made(new TlsContext(context, rules));
  if (!SetProtocol(context, rules)) {
    ERR_clear_error();
    return absl::InternalError("OpenSSL: none of the suites or groups");
  }
  if (!identity::UseChain(context, texts.certificate) || !identity::UseKey(context, texts.key) ||
      !TrustAuthorities(context, texts.client_ca)) {
    ERR_clear_error();
    return absl::FailedPreconditionError("OpenSSL does not take certificate, key or authority");
  }
  ERR_clear_error();
  return made;
}

TlsContext::~TlsContext() { SSL_CTX_free(context_); }

}  // namespace uplink::front
