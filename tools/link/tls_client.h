#pragma once

#include <memory>
#include <string>

#include <absl/status/statusor.h>

// OpenSSL's own names: its headers stop at this folder's sources.
using SSL = struct ssl_st;
using SSL_CTX = struct ssl_ctx_st;
using X509 = struct x509_st;
using EVP_PKEY = struct evp_pkey_st;

namespace uplink::link {

/// A client certificate and its key, read once and shared by all connections that show it. A value.
class Identity final {
 public:
  /// Errors: kInvalidArgument for text that is not PEM, or a key that is not the certificate's.
  [[nodiscard]] static absl::StatusOr<Identity> Parse(const std::string& certificate_pem,
                                                      const std::string& key_pem);

 private:
  friend class TlsClient;
  std::shared_ptr<X509> certificate_;
  std::shared_ptr<EVP_PKEY> key_;
};

/// What the client offers in the handshake (ALPN).
enum class Alpn : unsigned char { kNone, kHttp2 };

/// What all TLS connections of a program share: which authorities to trust, and what to offer.
/// TLS 1.2 and 1.3, no tickets, so that every connection is a whole handshake, as after a restart
/// of the server.
///
/// Thread: immutable once made; NewSession may be called from several threads.
class TlsClient final {
 public:
  using Session = std::unique_ptr<SSL, void (*)(SSL*)>;

  /// Errors: kInvalidArgument for an authority that is not PEM.
  [[nodiscard]] static absl::StatusOr<std::shared_ptr<const TlsClient>> Create(
      const std::string& ca_pem, Alpn alpn);

  /// A session for a server that must be `host` (a name or an address), as this robot.
  [[nodiscard]] Session NewSession(const Identity& identity, const std::string& host) const;

 private:
  explicit TlsClient(std::shared_ptr<SSL_CTX> context) : context_(std::move(context)) {}

  std::shared_ptr<SSL_CTX> context_;
};

/// The session's server must be `host`, a name or an address, and is asked for by it.
void ExpectHost(SSL* session, const std::string& host);

/// OpenSSL's own words for the oldest error of this thread; empties its queue.
[[nodiscard]] std::string TakeTlsError();

}  // namespace uplink::link
