#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <absl/status/status.h>
#include <openssl/types.h>
#include <openssl/x509.h>

#include "server/identity/fleet_bounds.h"
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

/// The name (DER) and the digest of the key: the same authority, whichever of its certificates.
using AuthorityOwner = std::pair<std::string, ShownCertificate::Sha256>;
[[nodiscard]] AuthorityOwner OwnerOf(const X509& authority);

/// What authorities may vouch for, by their certificates, or else by the name and key of one. One
/// without a rule may vouch for all. A value.
class AuthorityRules final {
 public:
  /// The rule of each certificate of the text. Errors: kFailedPrecondition: it cannot be read, or a
  /// certificate has a rule already.
  [[nodiscard]] absl::Status Add(const NamedPem& authorities, const AuthorityRule& rule);

  /// Errors: kUnauthenticated with a sentence for the peer: the authority may not vouch for its
  /// role
  ///         or fleet.
  [[nodiscard]] absl::Status Judge(const PeerIdentity& peer, const X509& authority) const;
  /// The same of a verified chain: each authority in it that has a rule must vouch for the peer,
  /// also one that is trusted only because another that we trust has signed it.
  [[nodiscard]] absl::Status Judge(const PeerIdentity& peer, const STACK_OF(X509) * chain) const;
  /// The same of the chain that a handshake verified.
  [[nodiscard]] absl::Status Judge(const PeerIdentity& peer, const SSL* connection) const;

  /// The fleets of the first authority in the chain whose rule names some; null: none does.
  [[nodiscard]] FleetBoundsPtr BoundsOf(const STACK_OF(X509) * chain) const;

  /// Whether the authority has a rule.
  [[nodiscard]] bool Has(const X509& authority) const { return Find(authority) != nullptr; }
  [[nodiscard]] std::size_t size() const { return rules_.size(); }
  friend bool operator==(const AuthorityRules&, const AuthorityRules&) = default;

 private:
  /// Null: it has none.
  [[nodiscard]] const AuthorityRule* Find(const X509& authority) const;

  std::map<ShownCertificate::Sha256, AuthorityRule> rules_;
  std::map<AuthorityOwner, AuthorityRule> by_owner_;
};

}  // namespace uplink::identity
