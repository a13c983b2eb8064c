#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <absl/status/status.h>
#include <openssl/types.h>

#include "server/identity/peer_identity.h"
#include "server/identity/pem_file.h"
#include "server/identity/scope.h"
#include "server/identity/shown_certificate.h"

namespace uplink::identity {

/// Any role, by its text; nothing for another text.
[[nodiscard]] std::optional<Role> RoleOf(std::string_view text);

/// What one authority may vouch for. A value.
struct AuthorityRule {
  /// What operators call it.
  std::string name;
  /// Empty: every role.
  std::vector<Role> roles{};
  Scope fleets = Scope::All();

  friend bool operator==(const AuthorityRule&, const AuthorityRule&) = default;
};

/// What authorities may vouch for, by their certificates. One without a rule may vouch for all. A
/// value.
class AuthorityRules final {
 public:
  /// The rule of each certificate of the text. Errors: kFailedPrecondition: it cannot be read, or a
  /// certificate has a rule already.
  [[nodiscard]] absl::Status Add(const NamedPem& authorities, const AuthorityRule& rule);

  /// Errors: kUnauthenticated with a sentence for the peer: the authority that verified its chain
  ///         may not vouch for its role or fleet.
  [[nodiscard]] absl::Status Judge(const PeerIdentity& peer, const X509& authority) const;
  /// The same by the digest of the authority's certificate.
  [[nodiscard]] absl::Status Judge(const PeerIdentity& peer,
                                   const ShownCertificate::Sha256& authority) const;
  /// The same of the chain that a handshake verified.
  [[nodiscard]] absl::Status Judge(const PeerIdentity& peer, const SSL* connection) const;

  /// Whether the certificate with this digest has a rule.
  [[nodiscard]] bool Has(const ShownCertificate::Sha256& authority) const {
    return rules_.contains(authority);
  }
  [[nodiscard]] std::size_t size() const { return rules_.size(); }
  friend bool operator==(const AuthorityRules&, const AuthorityRules&) = default;

 private:
  std::map<ShownCertificate::Sha256, AuthorityRule> rules_;
};

}  // namespace uplink::identity
