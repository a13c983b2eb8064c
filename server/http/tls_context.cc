#include "server/http/tls_context.h"

#include <algorithm>
#include <utility>

#include <fmt/core.h>
#include <openssl/err.h>
#include <openssl/ssl.h>
#include <openssl/x509.h>
#include <openssl/x509_vfy.h>

#include "schema/base/check.h"
#include "server/identity/expiry.h"
#include "server/identity/pem.h"
#include "server/identity/shown_certificate.h"
#include "server/transport/tls_settings.h"

namespace uplink::http {
namespace {

/// HTTP/1.1 in ALPN's form: its length, its name.
constexpr unsigned char kHttp11[] = {8, 'h', 't', 't', 'p', '/', '1', '.', '1'};

int ChooseProtocol(SSL* /*ssl*/, const unsigned char** chosen, unsigned char* chosen_size,
                   const unsigned char* offered, unsigned int offered_size, void* /*argument*/) {
  unsigned char* found = nullptr;
  if (SSL_select_next_proto(&found, chosen_size, kHttp11, sizeof kHttp11, offered, offered_size) !=
      OPENSSL_NPN_NEGOTIATED) {
    return SSL_TLSEXT_ERR_ALERT_FATAL;
  }
  *chosen = found;
  return SSL_TLSEXT_ERR_OK;
}

/// OpenSSL keeps the error, for CertificateOf.
int OnVerified(int /*good*/, X509_STORE_CTX* /*store*/) { return 1; }

/// What is wrong with a chain with this X509_V_ERR_....
absl::Status FlawOf(int verify_error, int depth) {
  if (transport::IsTrusted(verify_error, depth)) return transport::FlawOfTrusted(verify_error);
  return absl::UnauthenticatedError(
      fmt::format("client certificate: no authority of operators vouches for it: {}",
                  X509_verify_cert_error_string(verify_error)));
}

void FreeRules(void* /*context*/, void* rules, CRYPTO_EX_DATA* /*data*/, int /*index*/,
               long /*number*/, void* /*pointer*/) {  // NOLINT(google-runtime-int): the library's
  delete static_cast<const identity::AuthorityRules*>(rules);
}

/// Where a context keeps what its authorities may vouch for, which ends with it.
int RulesIndex() {
  static const int index = SSL_CTX_get_ex_new_index(0, nullptr, nullptr, nullptr, FreeRules);
  return index;
}

/// Null: they may vouch for all.
const identity::AuthorityRules* RulesOf(const SSL_CTX* context) {
  return static_cast<const identity::AuthorityRules*>(SSL_CTX_get_ex_data(context, RulesIndex()));
}

std::shared_ptr<const PeerCertificate> Shown(X509& certificate, const STACK_OF(X509) * chain,
                                             int verify_error, const SSL_CTX* context) {
  auto shown = std::make_shared<PeerCertificate>(
      PeerCertificate{.identity = identity::IdentityOf(certificate),
                      .subject = identity::SubjectOf(certificate),
                      .expiry = identity::NotAfterOf(certificate),
                      .chain = identity::NamedBy(certificate, chain)});
  for (int i = 0; i < sk_X509_num(chain); ++i) {
    shown->expiry = std::min(shown->expiry, identity::NotAfterOf(*sk_X509_value(chain, i)));
  }
  const identity::AuthorityRules* const rules = RulesOf(context);
  if (rules != nullptr && shown->identity.ok()) {
    absl::Status may = rules->Judge(*shown->identity, chain);
    if (!may.ok()) shown->identity = std::move(may);
  }
  if (verify_error != X509_V_OK) shown->identity = FlawOf(verify_error, 0);
  ERR_clear_error();
  return shown;
}

struct StoreContextFree {
  void operator()(X509_STORE_CTX* context) const { X509_STORE_CTX_free(context); }
};

}  // namespace

void SslContextFree::operator()(SSL_CTX* context) const { SSL_CTX_free(context); }

absl::StatusOr<std::shared_ptr<SSL_CTX>> MakeTlsContext(const transport::PemTexts& texts,
                                                        const transport::TlsRules& rules) {
  if (absl::Status good = transport::CheckTexts(texts); !good.ok()) return good;
  std::shared_ptr<SSL_CTX> context(SSL_CTX_new(TLS_server_method()), SslContextFree());
  if (context == nullptr) return absl::InternalError("OpenSSL: no context");
  SSL_CTX_set_alpn_select_cb(context.get(), ChooseProtocol, nullptr);
  SSL_CTX_set_verify(context.get(), SSL_VERIFY_PEER, OnVerified);
  if (!transport::SetProtocol(context.get(), rules)) {
    ERR_clear_error();
    return absl::InternalError("OpenSSL: none of the suites or groups");
  }
  if (!identity::UseChain(context.get(), texts.certificate) ||
      !identity::UseKey(context.get(), texts.key) ||
      !transport::TrustAuthorities(context.get(), texts.client_ca)) {
    ERR_clear_error();
    return absl::FailedPreconditionError("OpenSSL does not take certificate, key or authority");
  }
  ERR_clear_error();
  SSL_CTX_set_ex_data(context.get(), RulesIndex(), new identity::AuthorityRules(texts.rules));
  return context;
}

std::shared_ptr<const PeerCertificate> CertificateOf(const SSL* connection) {
  X509* const certificate = SSL_get0_peer_certificate(connection);
  if (certificate == nullptr) return nullptr;
  return Shown(*certificate, SSL_get0_verified_chain(connection),
               static_cast<int>(SSL_get_verify_result(connection)), SSL_get_SSL_CTX(connection));
}

std::shared_ptr<const PeerCertificate> JudgeAgain(const SSL* connection, SSL_CTX* context) {
  X509* const certificate = SSL_get0_peer_certificate(connection);
  if (certificate == nullptr) return nullptr;
  const std::unique_ptr<X509_STORE_CTX, StoreContextFree> store(X509_STORE_CTX_new());
  UPLINK_CHECK(store != nullptr, "out of memory");
  // As OpenSSL judges it in a handshake.
  const bool begun = X509_STORE_CTX_init(store.get(), SSL_CTX_get_cert_store(context), certificate,
                                         SSL_get_peer_cert_chain(connection)) == 1 &&
                     X509_STORE_CTX_set_default(store.get(), "ssl_client") == 1 &&
                     X509_VERIFY_PARAM_set1(X509_STORE_CTX_get0_param(store.get()),
                                            SSL_CTX_get0_param(context)) == 1;
  UPLINK_CHECK(begun, "out of memory");
  X509_STORE_CTX_set_verify_cb(store.get(), OnVerified);
  X509_VERIFY_PARAM_set_auth_level(X509_STORE_CTX_get0_param(store.get()),
                                   SSL_CTX_get_security_level(context));
  X509_verify_cert(store.get());
  return Shown(*certificate, X509_STORE_CTX_get0_chain(store.get()),
               X509_STORE_CTX_get_error(store.get()), context);
}

absl::Status ServedTls::Serve() {
  auto made = MakeTlsContext(files_.texts(), rules_);
  if (!made.ok()) return made.status();
  const std::lock_guard lock(mutex_);
  context_ = *std::move(made);
  return absl::OkStatus();
}

transport::FilesLook ServedTls::Refresh() {
  const auto fresh = files_.Refresh();
  if (!fresh.ok()) return {fresh.status(), files_.served()};
  // The same texts have the same result as before.
  if (*fresh) served_ = Serve();
  return {served_, files_.served()};
}

const std::shared_ptr<const PeerCertificate>& JudgedCertificate::Now(const ServedTls& tls,
                                                                     const SSL* connection) {
  std::shared_ptr<SSL_CTX> now = tls.get();
  if (now != by_) {
    by_ = std::move(now);
    certificate_ = JudgeAgain(connection, by_.get());
  }
  return certificate_;
}

}  // namespace uplink::http
