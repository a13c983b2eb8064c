#pragma once

#include <cstddef>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <unordered_set>
#include <utility>
#include <vector>

#include <openssl/safestack.h>
#include <openssl/types.h>
#include <openssl/x509.h>

#include "server/identity/shown_certificate.h"
#include "storage/access_store.h"

namespace uplink::identity {

/// Certificates and keys that may not come in: those that operators revoked, and those of the
/// authorities' lists (CRL). Immutable once shared.
class DeniedCertificates final {
 public:
  /// False if the value is not one of its kind, or the kind none of ours: then it names nothing.
  bool Add(storage::RevokedBy by, std::string_view value);
  void Add(const SignedSerial& certificate);

  [[nodiscard]] std::size_t size() const {
    return by_issuer_serial_.size() + by_signer_serial_.size() + by_certificate_.size() +
           by_key_.size();
  }
  /// Whether the list names the certificate by a digest of it or of its key.
  [[nodiscard]] bool NamesDigest(const ShownCertificate& certificate) const;
  /// Whether it names one with this serial. Cheap, so that few issuers are written out.
  [[nodiscard]] bool NamesSerial(std::string_view serial) const;
  /// By the issuer's name: that of every authority which has it.
  [[nodiscard]] bool NamesIssued(std::string_view serial, std::string_view issuer) const;
  /// By the issuer's key.
  [[nodiscard]] bool NamesSigned(std::string_view serial,
                                 const ShownCertificate::Sha256& signer) const;

 private:
  /// So that a view can be looked up.
  struct Hash : std::hash<std::string_view> {
    using is_transparent = void;
  };
  using Set = std::unordered_set<std::string, Hash, std::equal_to<>>;

  /// `SERIAL ISSUER`; the bytes of the signer's digest and the serial; the serials of both.
  Set by_issuer_serial_;
  Set by_signer_serial_;
  Set serials_;
  /// The 32 bytes of each digest.
  Set by_certificate_;
  Set by_key_;
};

using DeniedPtr = std::shared_ptr<const DeniedCertificates>;

/// The list that counts now. It changes as a whole.
///
/// Thread: thread-safe. Get takes a reference under a lock; the list itself needs none.
class DenyList final {
 public:
  /// Never null.
  [[nodiscard]] DeniedPtr Get() const {
    const std::lock_guard lock(mutex_);
    return list_;
  }
  void Set(DeniedPtr list) {
    const std::lock_guard lock(mutex_);
    std::swap(list_, list);
  }

 private:
  mutable std::mutex mutex_;
  DeniedPtr list_ = std::make_shared<DeniedCertificates>();
};

/// What a list may name of one certificate, for those who look after the connection's library has
/// gone. A value.
struct NamedCertificate {
  ShownCertificate shown;
  std::string issuer;
  /// The digest of the key that signed it.
  ShownCertificate::Sha256 signer{};
};

/// What a list may name of a peer that showed `own`: that, and what signed it, other than the
/// authority that we trust. `chain`: as the handshake verified it, `own` first; null or empty: it
/// did not.
[[nodiscard]] std::vector<NamedCertificate> NamedBy(const X509& own, const STACK_OF(X509) * chain);
/// Whether the list names one of them. Pure.
[[nodiscard]] bool Denies(const DeniedCertificates& list,
                          const std::vector<NamedCertificate>& chain);

/// Whether the list names the certificate of a connection's peer, or one that signed it, other than
/// the authority that we trust. `shown`: of the peer's own. Cheap unless the list holds its serial.
///
/// Thread: that of the connection.
[[nodiscard]] bool Denies(const DeniedCertificates& list, const SSL* connection,
                          const ShownCertificate& shown);

}  // namespace uplink::identity
