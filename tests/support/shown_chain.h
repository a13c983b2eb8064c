#pragma once

#include <memory>
#include <string>
#include <vector>

#include <openssl/types.h>

namespace uplink::testing {

/// Certificates of any kind that a client shows behind its own. OpenSSL reads each once, and the
/// same one that stands there several times once: with the worst of them that takes long.
///
/// Thread: any; it never changes.
class ShownChain final {
 public:
  /// In DER.
  explicit ShownChain(const std::vector<std::string>& certificates);
  ~ShownChain();
  ShownChain(const ShownChain&) = delete;
  ShownChain& operator=(const ShownChain&) = delete;

  /// Has clients of the context show them, whatever the library thinks of their keys.
  void AddTo(SSL_CTX* context) const;

 private:
  std::vector<X509*> certificates_;
};

}  // namespace uplink::testing
