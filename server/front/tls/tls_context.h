#pragma once

#include <memory>
#include <mutex>
#include <utility>

#include <absl/status/statusor.h>
#include <openssl/types.h>

#include "server/identity/trusted_authorities.h"
#include "server/transport/options.h"

namespace uplink::front {

/// What handshakes need: certificate, key and authorities; only HTTP/2 by ALPN; a client
/// certificate, which the rules may leave to the peer; no tickets and no session cache, since
/// robots do not resume sessions. Immutable; connections keep the context that they began with.
///
/// A trusted chain with wrong dates or a wrong purpose passes the handshake: in TLS 1.3 the peer
/// has finished by then, and would never learn why it was rejected. TlsEngine::Peer says what is
/// wrong with it, and no call of it is served.
class TlsContext final {
 public:
  /// Errors: kFailedPrecondition names the text that is invalid.
  [[nodiscard]] static absl::StatusOr<std::shared_ptr<const TlsContext>> Make(
      const transport::PemTexts& texts, const transport::TlsRules& rules);
  ~TlsContext();
  TlsContext(const TlsContext&) = delete;
  TlsContext& operator=(const TlsContext&) = delete;

  [[nodiscard]] SSL_CTX* get() const { return context_; }
  [[nodiscard]] const transport::TlsRules& rules() const { return rules_; }
  [[nodiscard]] const identity::TrustedAuthorities& trusted() const { return trusted_; }

 private:
  TlsContext(SSL_CTX* context, const transport::TlsRules& rules,
             identity::TrustedAuthorities trusted)
      : context_(context), rules_(rules), trusted_(std::move(trusted)) {}

  SSL_CTX* const context_;
  const transport::TlsRules rules_;
  const identity::TrustedAuthorities trusted_;
};

/// The context that new connections begin with; replaced when the files change. Thread-safe.
class ServedContext final {
 public:
  [[nodiscard]] std::shared_ptr<const TlsContext> get() const {
    const std::lock_guard lock(mutex_);
    return context_;
  }
  void Set(std::shared_ptr<const TlsContext> context) {
    const std::lock_guard lock(mutex_);
    context_ = std::move(context);
  }

 private:
  mutable std::mutex mutex_;
  std::shared_ptr<const TlsContext> context_;
};

}  // namespace uplink::front
