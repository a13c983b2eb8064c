#include "tools/link/tls_client.h"

#include <array>
#include <utility>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <openssl/err.h>
#include <openssl/ssl.h>
#include <openssl/x509v3.h>

#include "schema/base/check.h"
#include "server/identity/pem.h"

namespace uplink::link {
namespace {

/// `host` is an address of either family.
bool IsAddress(const std::string& host) {
  in6_addr any{};
  return inet_pton(AF_INET, host.c_str(), &any) == 1 ||
         inet_pton(AF_INET6, host.c_str(), &any) == 1;
}

}  // namespace

void ExpectHost(SSL* session, const std::string& host) {
  if (IsAddress(host)) {
    X509_VERIFY_PARAM_set1_ip_asc(SSL_get0_param(session), host.c_str());
  } else {
    // A name only in the subject proves no host (RFC 6125).
    SSL_set_hostflags(session, X509_CHECK_FLAG_NEVER_CHECK_SUBJECT);
    SSL_set1_host(session, host.c_str());
    // OpenSSL's macro casts in C's way and wants a mutable name, which it copies.
    SSL_ctrl(session, SSL_CTRL_SET_TLSEXT_HOSTNAME, TLSEXT_NAMETYPE_host_name,
             const_cast<char*>(host.c_str()));
  }
}

std::string TakeTlsError() {
  std::array<char, 256> text{};
  const unsigned long error = ERR_get_error();
  ERR_clear_error();
  if (error == 0) return "no reason given";
  ERR_error_string_n(error, text.data(), text.size());
  return text.data();
}

absl::StatusOr<Identity> Identity::Parse(const std::string& certificate_pem,
                                         const std::string& key_pem) {
  Identity identity;
  auto certificates = identity::ReadCertificates({"the certificate", certificate_pem});
  if (!certificates.ok()) return absl::InvalidArgumentError(certificates.status().message());
  auto key = identity::ReadKey({"the key", key_pem});
  if (!key.ok()) return absl::InvalidArgumentError(key.status().message());
  identity.certificate_ = std::move(certificates->front());
  identity.key_ = *std::move(key);
  if (X509_check_private_key(identity.certificate_.get(), identity.key_.get()) != 1) {
    return absl::InvalidArgumentError("certificate and key: " + TakeTlsError());
  }
  return identity;
}

absl::StatusOr<std::shared_ptr<const TlsClient>> TlsClient::Create(const std::string& ca_pem,
                                                                   Alpn alpn) {
  std::shared_ptr<SSL_CTX> context(SSL_CTX_new(TLS_client_method()), SSL_CTX_free);
  UPLINK_CHECK(context != nullptr, "OpenSSL makes a context");
  const auto authorities = identity::ReadCertificates({"the authority", ca_pem});
  if (!authorities.ok()) return absl::InvalidArgumentError(authorities.status().message());
  for (const identity::Certificate& authority : *authorities) {
    if (X509_STORE_add_cert(SSL_CTX_get_cert_store(context.get()), authority.get()) != 1) {
      return absl::InvalidArgumentError("certificate of the authority: " + TakeTlsError());
    }
  }
  SSL_CTX_set_verify(context.get(), SSL_VERIFY_PEER, nullptr);
  SSL_CTX_set_min_proto_version(context.get(), TLS1_2_VERSION);
  SSL_CTX_set_session_cache_mode(context.get(), SSL_SESS_CACHE_OFF);
  SSL_CTX_set_options(context.get(), SSL_OP_NO_TICKET | SSL_OP_IGNORE_UNEXPECTED_EOF);
  SSL_CTX_set_mode(context.get(), SSL_MODE_ENABLE_PARTIAL_WRITE |
                                      SSL_MODE_ACCEPT_MOVING_WRITE_BUFFER |
                                      SSL_MODE_RELEASE_BUFFERS);
  if (alpn == Alpn::kHttp2) {
    constexpr std::array<unsigned char, 3> kHttp2 = {2, 'h', '2'};
    SSL_CTX_set_alpn_protos(context.get(), kHttp2.data(), kHttp2.size());
  }
  return std::shared_ptr<const TlsClient>(new TlsClient(std::move(context)));
}

TlsClient::Session TlsClient::NewSession(const Identity& identity, const std::string& host) const {
  Session session(SSL_new(context_.get()), SSL_free);
  UPLINK_CHECK(session != nullptr, "OpenSSL makes a session");
  SSL_use_certificate(session.get(), identity.certificate_.get());
  SSL_use_PrivateKey(session.get(), identity.key_.get());
  ExpectHost(session.get(), host);
  SSL_set_connect_state(session.get());
  return session;
}

}  // namespace uplink::link
