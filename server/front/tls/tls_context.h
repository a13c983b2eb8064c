#pragma once

#include <memory>
#include <mutex>

#include <absl/status/statusor.h>
#include <openssl/types.h>

#include "server/transport/options.h"

namespace uplink::front {

/// What handshakes need: certificate, key and authorities; HTTP/2 alone by ALPN; a client
/// certificate required; no tickets and no session memory, since robots do not come back with them.
/// Immutable; connections keep the one that they began with.
///
/// A chain that is trusted but for its dates, or for what its certificate may be used for, passes
/// the handshake: the peer has finished by then (TLS 1.3) and would never learn why it was sent
/// away. TlsEngine::Peer says what is wrong with it, and nobody may serve it.
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

 private:
  TlsContext(SSL_CTX* context, const transport::TlsRules& rules)
      : context_(context), rules_(rules) {}

  SSL_CTX* const context_;
  const transport::TlsRules rules_;
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
