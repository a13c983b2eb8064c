#include "server/mqtt/tls_context.h"

#include <string_view>

#include <arpa/inet.h>
#include <fmt/core.h>
#include <netinet/in.h>
#include <openssl/err.h>
#include <openssl/ssl.h>
#include <openssl/x509v3.h>

#include "server/identity/pem.h"

namespace uplink::mqtt {
namespace {

bool TrustAuthorities(SSL_CTX* context, std::string_view text) {
  if (text.empty()) return SSL_CTX_set_default_verify_paths(context) == 1;
  const auto authorities = identity::ReadCertificates({"", std::string(text)});
  if (!authorities.ok()) return false;
  X509_STORE* store = SSL_CTX_get_cert_store(context);
  for (const identity::Certificate& next : *authorities) {
    if (X509_STORE_add_cert(store, next.get()) != 1) return false;
  }
  return true;
}

absl::Status Refused(std::string_view key) {
  ERR_clear_error();
  return absl::FailedPreconditionError(fmt::format("mqtt.{}: OpenSSL does not take it", key));
}

/// `host` is an address of either family.
bool IsAddress(const std::string& host) {
  in6_addr any{};
  return inet_pton(AF_INET, host.c_str(), &any) == 1 ||
         inet_pton(AF_INET6, host.c_str(), &any) == 1;
}

/// What SSL_set_tlsext_host_name does, without its casts: the name is copied.
bool SetServerName(SSL* connection, std::string name) {
  return SSL_ctrl(connection, SSL_CTRL_SET_TLSEXT_HOSTNAME, TLSEXT_NAMETYPE_host_name,
                  name.data()) == 1;
}

}  // namespace

void SslContextFree::operator()(SSL_CTX* context) const { SSL_CTX_free(context); }

absl::StatusOr<SslContext> MakeSslContext(const TlsTexts& tls) {
  SslContext context(SSL_CTX_new(TLS_client_method()));
  if (context == nullptr || SSL_CTX_set_min_proto_version(context.get(), TLS1_2_VERSION) != 1) {
    ERR_clear_error();
    return absl::InternalError("OpenSSL: no context");
  }
  SSL_CTX_set_options(context.get(), SSL_OP_NO_RENEGOTIATION | SSL_OP_NO_COMPRESSION);
  SSL_CTX_set_mode(context.get(), SSL_MODE_RELEASE_BUFFERS | SSL_MODE_ENABLE_PARTIAL_WRITE |
                                      SSL_MODE_ACCEPT_MOVING_WRITE_BUFFER);
  SSL_CTX_set_verify(context.get(), SSL_VERIFY_PEER, nullptr);
  if (!TrustAuthorities(context.get(), tls.ca)) return Refused("ca_file");
  if (!tls.certificate.empty()) {
    if (!identity::UseChain(context.get(), tls.certificate))
      return Refused("client_certificate_file");
    if (!identity::UseKey(context.get(), tls.key) ||
        SSL_CTX_check_private_key(context.get()) != 1) {
      return Refused("client_key_file");
    }
  }
  ERR_clear_error();
  return context;
}

absl::Status AskForHost(SSL* connection, const Url& url) {
  bool taken = false;
  if (IsAddress(url.host)) {
    X509_VERIFY_PARAM* const verify = SSL_get0_param(connection);
    taken = X509_VERIFY_PARAM_set1_ip_asc(verify, url.host.c_str()) == 1;
  } else {
    // A name only in the subject proves no host (RFC 6125).
    SSL_set_hostflags(connection,
                      X509_CHECK_FLAG_NO_PARTIAL_WILDCARDS | X509_CHECK_FLAG_NEVER_CHECK_SUBJECT);
    taken = SSL_set1_host(connection, url.host.c_str()) == 1 && SetServerName(connection, url.host);
  }
  ERR_clear_error();
  return taken ? absl::OkStatus() : absl::InternalError("OpenSSL does not take the broker's name");
}

const char* VerifyText(const SSL* connection) {
  const long result = SSL_get_verify_result(connection);
  return result == X509_V_OK ? "" : X509_verify_cert_error_string(result);
}

}  // namespace uplink::mqtt
