#include "server/identity/trusted_authorities.h"

#include <string>
#include <utility>

#include <openssl/crypto.h>
#include <openssl/ssl.h>
#include <openssl/x509.h>

#include "server/identity/pem.h"

namespace uplink::identity {

absl::StatusOr<TrustedAuthorities> TrustedAuthorities::Of(const NamedPem& authorities,
                                                          AuthorityRules rules) {
  const auto certificates = ReadCertificates(authorities);
  if (!certificates.ok()) return certificates.status();
  TrustedAuthorities trusted;
  trusted.rules_ = std::move(rules);
  for (const Certificate& each : *certificates) {
    const ShownCertificate::Sha256 digest = DigestOf(*each);
    trusted.certificates_.insert(digest);
    trusted.owners_.insert_or_assign(OwnerOf(*each), digest);
  }
  return trusted;
}

TrustedAuthorities::Owner TrustedAuthorities::OwnerOf(const X509& certificate) {
  unsigned char* bytes = nullptr;
  const int size = i2d_X509_NAME(X509_get_subject_name(&certificate), &bytes);
  if (size <= 0) return {};
  Owner owner{std::string(bytes, bytes + size), KeyDigestOf(certificate)};
  OPENSSL_free(bytes);
  return owner;
}

absl::Status TrustedAuthorities::JudgeAgain(const PeerIdentity& peer, const SSL* connection,
                                            const AuthorityRules& earlier) const {
  const STACK_OF(X509)* const chain = SSL_get0_verified_chain(connection);
  const int size = sk_X509_num(chain);
  if (size < 1) return absl::OkStatus();
  // The last is the one that vouched for it; one before it may vouch now.
  for (int i = size - 1; i >= 0; --i) {
    const X509& each = *sk_X509_value(chain, i);
    const ShownCertificate::Sha256 digest = DigestOf(each);
    if (certificates_.contains(digest)) return rules_.Judge(peer, digest);
    const auto renewed = owners_.find(OwnerOf(each));
    if (renewed != owners_.end()) return rules_.Judge(peer, renewed->second);
  }
  if (!earlier.Has(DigestOf(*sk_X509_value(chain, size - 1)))) return absl::OkStatus();
  return absl::UnauthenticatedError("client certificate: its authority is not trusted any more");
}

}  // namespace uplink::identity
