#include "server/identity/trusted_authorities.h"

#include <utility>

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
    trusted.certificates_.insert(DigestOf(*each));
    trusted.owners_.insert(OwnerOf(*each));
  }
  return trusted;
}

absl::Status TrustedAuthorities::JudgeAgain(const PeerIdentity& peer, const SSL* connection,
                                            const AuthorityRules& earlier) const {
  const STACK_OF(X509)* const chain = SSL_get0_verified_chain(connection);
  const int size = sk_X509_num(chain);
  if (size < 1) return absl::OkStatus();
  // The last is the one that vouched for it; one before it may vouch now.
  for (int i = size - 1; i >= 0; --i) {
    const X509& each = *sk_X509_value(chain, i);
    if (!certificates_.contains(DigestOf(each)) && !owners_.contains(OwnerOf(each))) continue;
    // Those that it signed may have a rule too.
    for (int below = i; below >= 0; --below) {
      absl::Status may = rules_.Judge(peer, *sk_X509_value(chain, below));
      if (!may.ok()) return may;
    }
    return absl::OkStatus();
  }
  if (!earlier.Has(*sk_X509_value(chain, size - 1))) return absl::OkStatus();
  return absl::UnauthenticatedError("client certificate: its authority is not trusted any more");
}

}  // namespace uplink::identity
