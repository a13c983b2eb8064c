#include "server/identity/authority_rules.h"

#include <algorithm>
#include <array>
#include <memory>

#include <fmt/format.h>
#include <openssl/crypto.h>
#include <openssl/ssl.h>
#include <openssl/x509.h>

#include "server/identity/pem.h"

namespace uplink::identity {
namespace {

constexpr std::array kRoles = {Role::kRobot,    Role::kGateway, Role::kViewer,
                               Role::kOperator, Role::kAdmin,   Role::kMetrics};

absl::Status Outside(const AuthorityRule& rule, std::string_view what) {
  return absl::UnauthenticatedError(
      fmt::format("client certificate: its authority {} may not vouch for {}", rule.name, what));
}

/// Of all fleets only an authority that may vouch for every fleet.
bool HasFleet(const AuthorityRule& rule, const std::string& fleet) {
  return rule.fleets.all() || rule.fleets.Has(fleet);
}

}  // namespace

std::optional<Role> RoleOf(std::string_view text) {
  const auto* const found =
      std::ranges::find_if(kRoles, [text](Role role) { return ToText(role) == text; });
  return found == kRoles.end() ? std::nullopt : std::optional(*found);
}

AuthorityOwner OwnerOf(const X509& authority) {
  unsigned char* bytes = nullptr;
  const int size = i2d_X509_NAME(X509_get_subject_name(&authority), &bytes);
  if (size <= 0) return {};
  AuthorityOwner owner{std::string(bytes, bytes + size), KeyDigestOf(authority)};
  OPENSSL_free(bytes);
  return owner;
}

absl::Status AuthorityRules::Add(const NamedPem& authorities, const AuthorityRule& rule) {
  const auto certificates = ReadCertificates(authorities);
  if (!certificates.ok()) return certificates.status();
  for (const Certificate& each : *certificates) {
    const auto [at, is_new] = rules_.emplace(DigestOf(*each), rule);
    if (!is_new && at->second.name != rule.name) {
      return absl::FailedPreconditionError(
          fmt::format("{}: its certificate is also in {}; keep one of them", authorities.name,
                      at->second.name));
    }
    by_owner_.insert_or_assign(OwnerOf(*each), rule);
  }
  return absl::OkStatus();
}

const AuthorityRule* AuthorityRules::Find(const X509& authority) const {
  if (rules_.empty()) return nullptr;
  const auto found = rules_.find(DigestOf(authority));
  if (found != rules_.end()) return &found->second;
  const auto renewed = by_owner_.find(OwnerOf(authority));
  return renewed == by_owner_.end() ? nullptr : &renewed->second;
}

absl::Status AuthorityRules::Judge(const PeerIdentity& peer, const X509& authority) const {
  const AuthorityRule* const found = Find(authority);
  if (found == nullptr) return absl::OkStatus();
  const AuthorityRule& rule = *found;
  if (!rule.roles.empty() && std::ranges::find(rule.roles, peer.role) == rule.roles.end()) {
    return Outside(rule, fmt::format("the role {}", ToText(peer.role)));
  }
  if (!HasFleet(rule, peer.fleet)) return Outside(rule, fmt::format("the fleet {}", peer.fleet));
  return absl::OkStatus();
}

absl::Status AuthorityRules::Judge(const PeerIdentity& peer, const STACK_OF(X509) * chain) const {
  for (int i = 0; i < sk_X509_num(chain); ++i) {
    if (absl::Status may = Judge(peer, *sk_X509_value(chain, i)); !may.ok()) return may;
  }
  return absl::OkStatus();
}

FleetBoundsPtr AuthorityRules::BoundsOf(const STACK_OF(X509) * chain) const {
  for (int i = 0; i < sk_X509_num(chain); ++i) {
    const AuthorityRule* const rule = Find(*sk_X509_value(chain, i));
    if (rule == nullptr || rule->fleets.all()) continue;
    return std::make_shared<const FleetBounds>(
        FleetBounds{.authority = rule->name, .fleets = rule->fleets});
  }
  return nullptr;
}

absl::Status AuthorityRules::Judge(const PeerIdentity& peer, const SSL* connection) const {
  if (rules_.empty()) return absl::OkStatus();
  const STACK_OF(X509)* const chain = SSL_get0_verified_chain(connection);
  if (sk_X509_num(chain) < 1) {
    return absl::UnauthenticatedError("client certificate: no authority is known");
  }
  return Judge(peer, chain);
}

}  // namespace uplink::identity
