#pragma once

#include <memory>
#include <string>

#include <absl/status/statusor.h>

// OpenSSL's own names: its headers stop at this folder's sources.
using SSL = struct ssl_st;
using SSL_CTX = struct ssl_ctx_st;
using X509 = struct x509_st;

namespace uplink::link {

/// Which servers a client of https believes, and what it shows them. A value; texts in PEM.
struct ServerTlsOptions {
  /// Authorities; empty: those of the system.
  std::string authorities;
  /// The one certificate that the server may show, whatever its names and dates say; empty:
  /// authorities decide.
  std::string server_certificate = {};
  /// False: any server is believed. For questions that tell it no secret.
  bool verify = true;
  /// The client's own, with those that lead to its authority; both or none.
  std::string certificate = {};
  std::string key = {};
};

/// The TLS of a client of https: TLS 1.2 or 1.3.
///
/// Thread: immutable once made; any thread.
class ServerTls final {
 public:
  /// Errors: kInvalidArgument for a text that is not PEM, or a key that is not the certificate's.
  [[nodiscard]] static absl::StatusOr<std::shared_ptr<const ServerTls>> Create(
      const ServerTlsOptions& options);

  using Session = std::unique_ptr<SSL, void (*)(SSL*)>;
  /// A session with a server that must be `host`, a name or an address.
  [[nodiscard]] Session NewSession(const std::string& host) const;

  /// Why a session whose handshake is over, or has failed, does not lead to the server that is
  /// meant; empty if it does.
  [[nodiscard]] std::string Distrust(const SSL& session) const;

 private:
  ServerTls() = default;

  std::shared_ptr<SSL_CTX> context_;
  /// Null unless one certificate alone is believed.
  std::shared_ptr<X509> server_certificate_;
  bool verify_ = true;
};

}  // namespace uplink::link
