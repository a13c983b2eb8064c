#pragma once

#include <memory>
#include <mutex>
#include <string>

#include <absl/status/statusor.h>
#include <openssl/types.h>

#include "server/http/credentials.h"
#include "server/transport/key_files.h"
#include "server/transport/options.h"

namespace uplink::http {

struct SslContextFree {
  void operator()(SSL_CTX* context) const;
};

/// What handshakes need: certificate, key and operators' authorities. HTTP/1.1 by ALPN, if the
/// client offers a choice. A client certificate is asked for and not required, and a chain with a
/// flaw passes the handshake: its peer learns what is wrong from the answer, or shows a token.
///
/// Errors: kFailedPrecondition names the text that is invalid.
[[nodiscard]] absl::StatusOr<std::shared_ptr<SSL_CTX>> MakeTlsContext(
    const transport::PemTexts& texts, const transport::TlsRules& rules);

/// What the peer of a finished handshake has shown; null: no certificate.
[[nodiscard]] std::shared_ptr<const PeerCertificate> CertificateOf(const SSL* connection);
/// The same by the authorities of another context, which may have changed since the handshake.
[[nodiscard]] std::shared_ptr<const PeerCertificate> JudgeAgain(const SSL* connection,
                                                                SSL_CTX* context);

/// The context that new connections begin with, from files that may change.
///
/// Thread: Refresh on one; get on any.
class ServedTls final {
 public:
  ServedTls(transport::PemFiles files, transport::TlsRules rules)
      : files_(std::move(files)), rules_(std::move(rules)) {}
  ServedTls(const ServedTls&) = delete;
  ServedTls& operator=(const ServedTls&) = delete;

  /// Reads the files again. New connections use them if they fit together, else the last good ones.
  transport::FilesLook Refresh();

  /// Null before the first good files.
  [[nodiscard]] std::shared_ptr<SSL_CTX> get() const {
    const std::lock_guard lock(mutex_);
    return context_;
  }

 private:
  [[nodiscard]] absl::Status Serve();

  transport::KeyFiles files_;
  const transport::TlsRules rules_;
  /// Whether the last texts could be served.
  absl::Status served_;
  mutable std::mutex mutex_;
  std::shared_ptr<SSL_CTX> context_;
};

/// The certificate that one connection has shown, by the authorities as they are now: one that was
/// taken away vouches for no further request. Confined to the connection's thread.
class JudgedCertificate final {
 public:
  /// What the handshake begins with; stays until the next Now.
  [[nodiscard]] SSL_CTX* Begin(const ServedTls& tls) {
    by_ = tls.get();
    return by_.get();
  }
  void Finish(const SSL* connection) { certificate_ = CertificateOf(connection); }
  /// Null: none was shown.
  [[nodiscard]] const std::shared_ptr<const PeerCertificate>& Now(const ServedTls& tls,
                                                                  const SSL* connection);

 private:
  /// Its authorities have judged the certificate.
  std::shared_ptr<SSL_CTX> by_;
  std::shared_ptr<const PeerCertificate> certificate_;
};

}  // namespace uplink::http
