#pragma once

#include <set>

#include <absl/status/status.h>
#include <absl/status/statusor.h>
#include <openssl/types.h>

#include "server/identity/authority_rules.h"
#include "server/identity/peer_identity.h"
#include "server/identity/pem_file.h"
#include "server/identity/shown_certificate.h"

namespace uplink::identity {

/// The authorities that a listener trusts, and what they may vouch for. A value.
class TrustedAuthorities final {
 public:
  TrustedAuthorities() = default;
  /// Errors: kFailedPrecondition: the text cannot be read.
  [[nodiscard]] static absl::StatusOr<TrustedAuthorities> Of(const NamedPem& authorities,
                                                             AuthorityRules rules);

  [[nodiscard]] const AuthorityRules& rules() const { return rules_; }

  /// Whether a peer that came in by `earlier` authorities may stay. One that is renewed with the
  /// same name and key is the same. One that is gone ends its peers only if it had a rule: those
  /// without stay until they connect anew.
  ///
  /// Errors: kUnauthenticated with a sentence for the peer.
  [[nodiscard]] absl::Status JudgeAgain(const PeerIdentity& peer, const SSL* connection,
                                        const AuthorityRules& earlier) const;

  friend bool operator==(const TrustedAuthorities&, const TrustedAuthorities&) = default;

 private:
  AuthorityRules rules_;
  /// The digests of their certificates, and whose those are.
  std::set<ShownCertificate::Sha256> certificates_;
  std::set<AuthorityOwner> owners_;
};

}  // namespace uplink::identity
