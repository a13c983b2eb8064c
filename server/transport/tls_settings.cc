#include "server/transport/tls_settings.h"

#include <string>

#include <openssl/ssl.h>
#include <openssl/x509.h>

#include "server/identity/certificate_gate.h"
#include "server/identity/pem.h"

namespace uplink::transport {
namespace {

/// The suites of TLS 1.2 that HTTP/2 allows. Suites with CBC, or without a key of its own for each
/// connection, are left out.
constexpr char kSuitesOf12[] = "ECDHE+AESGCM:ECDHE+CHACHA20";
/// Intermediate certificates between a peer and an authority.
constexpr int kChainDepthMax = 8;
// OpenSSL's depth counts neither the peer's certificate nor the authority's, and a peer may show
// both: so the longest verified chain may be shown completely.
static_assert(kChainDepthMax + 2 <= int{identity::kShownCertificatesMax});

}  // namespace

bool SetProtocol(SSL_CTX* context, const TlsRules& rules) {
  SSL_CTX_set_min_proto_version(
      context, rules.minimum == config::TlsVersion::k13 ? TLS1_3_VERSION : TLS1_2_VERSION);
  SSL_CTX_set_options(context,
                      SSL_OP_NO_TICKET | SSL_OP_NO_COMPRESSION | SSL_OP_CIPHER_SERVER_PREFERENCE);
  SSL_CTX_set_num_tickets(context, 0);
  SSL_CTX_set_session_cache_mode(context, SSL_SESS_CACHE_OFF);
  // An idle connection gives its buffers back: 34 of some 60 KiB (measured).
  SSL_CTX_set_mode(context, SSL_MODE_RELEASE_BUFFERS | SSL_MODE_ENABLE_PARTIAL_WRITE |
                                SSL_MODE_ACCEPT_MOVING_WRITE_BUFFER);
  SSL_CTX_set_verify_depth(context, kChainDepthMax);
  return SSL_CTX_set_cipher_list(context, kSuitesOf12) == 1 &&
         SSL_CTX_set1_groups_list(context, rules.groups.c_str()) == 1;
}

bool TrustAuthorities(SSL_CTX* context, std::string_view text) {
  const auto authorities = identity::ReadCertificates({"", std::string(text)});
  if (!authorities.ok()) return false;
  X509_STORE* store = SSL_CTX_get_cert_store(context);
  // The authority that signs peers may itself be signed by another.
  X509_STORE_set_flags(store, X509_V_FLAG_PARTIAL_CHAIN | X509_V_FLAG_TRUSTED_FIRST);
  for (const identity::Certificate& next : *authorities) {
    if (X509_STORE_add_cert(store, next.get()) != 1) return false;
    // Tells clients with several certificates which one to send.
    if (SSL_CTX_add_client_CA(context, next.get()) != 1) return false;
  }
  return true;
}

bool IsTrusted(int verify_error, int depth) {
  if (verify_error == X509_V_ERR_CERT_HAS_EXPIRED ||
      verify_error == X509_V_ERR_CERT_NOT_YET_VALID) {
    return true;
  }
  return verify_error == X509_V_ERR_INVALID_PURPOSE && depth == 0;
}

absl::Status FlawOfTrusted(int verify_error) {
  switch (verify_error) {
    case X509_V_ERR_CERT_HAS_EXPIRED:
      return absl::UnauthenticatedError(
          "client certificate: it, or one that signed it, has expired");
    case X509_V_ERR_CERT_NOT_YET_VALID:
      return absl::UnauthenticatedError(
          "client certificate: it, or one that signed it, is not valid yet");
    case X509_V_ERR_INVALID_PURPOSE:
      return absl::UnauthenticatedError(
          "client certificate: its key usage or extended key usage lacks what a client needs");
    default:  // IsTrusted lets no other through
      return absl::UnauthenticatedError("client certificate: it is not valid");
  }
}

}  // namespace uplink::transport
