#pragma once

#include <cstddef>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <unordered_set>

#include "server/identity/shown_certificate.h"

namespace uplink::identity {

/// Certificates and keys that may not come in: those that operators revoked, and those of the
/// authorities' lists (CRL). Immutable once shared.
struct DeniedCertificates {
  /// `SERIAL ISSUER`, as storage::RevokedBy::kIssuerSerial.
  std::unordered_set<std::string> by_issuer_serial;
  /// The 32 bytes of each digest.
  std::unordered_set<std::string> by_certificate;
  std::unordered_set<std::string> by_key;

  [[nodiscard]] std::size_t size() const {
    return by_issuer_serial.size() + by_certificate.size() + by_key.size();
  }
};

/// The list that counts now. It changes as a whole.
///
/// Thread: thread-safe. Get takes a reference under a lock; Has takes no lock.
class DenyList final {
 public:
  [[nodiscard]] std::shared_ptr<const DeniedCertificates> Get() const;
  void Set(std::shared_ptr<const DeniedCertificates> list);

 private:
  mutable std::mutex mutex_;
  std::shared_ptr<const DeniedCertificates> list_ = std::make_shared<DeniedCertificates>();
};

/// Whether the list names the certificate, or its key. Pure.
[[nodiscard]] bool Denies(const DeniedCertificates& list, const ShownCertificate& certificate,
                          std::string_view issuer);

}  // namespace uplink::identity
