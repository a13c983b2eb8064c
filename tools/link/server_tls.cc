#include "tools/link/server_tls.h"

#include <string_view>
#include <utility>

#include <openssl/ssl.h>
#include <openssl/x509v3.h>

#include "schema/base/check.h"
#include "server/identity/pem.h"
#include "tools/link/tls_client.h"

namespace uplink::link {
namespace {

absl::Status Wrong(const absl::Status& status) {
  return absl::InvalidArgumentError(status.message());
}

absl::Status Trust(SSL_CTX* context, const std::string& authorities) {
  if (authorities.empty()) {
    if (SSL_CTX_set_default_verify_paths(context) == 1) return absl::OkStatus();
    return absl::InvalidArgumentError("the system's authorities: " + TakeTlsError());
  }
  const auto certificates = identity::ReadCertificates({"the authority", authorities});
  if (!certificates.ok()) return Wrong(certificates.status());
  for (const identity::Certificate& authority : *certificates) {
    if (X509_STORE_add_cert(SSL_CTX_get_cert_store(context), authority.get()) != 1) {
      return absl::InvalidArgumentError("certificate of the authority: " + TakeTlsError());
    }
  }
  return absl::OkStatus();
}

absl::Status Show(SSL_CTX* context, const ServerTlsOptions& options) {
  if (options.certificate.empty()) return absl::OkStatus();
  const auto certificates = identity::ReadCertificates({"the certificate", options.certificate});
  if (!certificates.ok()) return Wrong(certificates.status());
  const auto key = identity::ReadKey({"the key", options.key});
  if (!key.ok()) return Wrong(key.status());
  if (!identity::UseChain(context, options.certificate) ||
      !identity::UseKey(context, options.key)) {
    return absl::InvalidArgumentError("certificate and key: " + TakeTlsError());
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<std::shared_ptr<const ServerTls>> ServerTls::Create(
    const ServerTlsOptions& options) {
  std::shared_ptr<ServerTls> tls(new ServerTls());
  tls->context_.reset(SSL_CTX_new(TLS_client_method()), SSL_CTX_free);
  SSL_CTX* const context = tls->context_.get();
  UPLINK_CHECK(context != nullptr, "OpenSSL makes a context");
  SSL_CTX_set_min_proto_version(context, TLS1_2_VERSION);
  SSL_CTX_set_session_cache_mode(context, SSL_SESS_CACHE_OFF);
  SSL_CTX_set_options(context, SSL_OP_NO_TICKET | SSL_OP_NO_RENEGOTIATION);
  tls->verify_ = options.verify;
  if (!options.server_certificate.empty()) {
    auto certificates =
        identity::ReadCertificates({"the server's certificate", options.server_certificate});
    if (!certificates.ok()) return Wrong(certificates.status());
    tls->server_certificate_ = std::move(certificates->front());
  } else if (options.verify) {
    if (absl::Status trusted = Trust(context, options.authorities); !trusted.ok()) return trusted;
    SSL_CTX_set_verify(context, SSL_VERIFY_PEER, nullptr);
  }
  if (absl::Status shown = Show(context, options); !shown.ok()) return shown;
  return tls;
}

ServerTls::Session ServerTls::NewSession(const std::string& host) const {
  Session session(SSL_new(context_.get()), SSL_free);
  UPLINK_CHECK(session != nullptr, "OpenSSL makes a session");
  ExpectHost(session.get(), host);
  return session;
}

std::string ServerTls::Distrust(const SSL& session) const {
  if (!verify_) return {};
  if (server_certificate_ == nullptr) {
    const long verdict = SSL_get_verify_result(&session);
    return verdict == X509_V_OK ? std::string() : X509_verify_cert_error_string(verdict);
  }
  const X509* const shown = SSL_get0_peer_certificate(&session);
  // Before the certificate came there is nothing to judge.
  if (shown == nullptr || X509_cmp(shown, server_certificate_.get()) == 0) return {};
  return "it shows another certificate than its configuration names";
}

}  // namespace uplink::link
