#include "server/identity/gateway.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>

#include <absl/strings/ascii.h>
#include <openssl/asn1.h>
#include <openssl/err.h>
#include <openssl/x509v3.h>

namespace uplink::identity {
namespace {

struct ConstraintsFree {
  void operator()(NAME_CONSTRAINTS* constraints) const { NAME_CONSTRAINTS_free(constraints); }
};
using Constraints = std::unique_ptr<NAME_CONSTRAINTS, ConstraintsFree>;

std::string TextOf(const ASN1_IA5STRING* text) {
  const auto* bytes = reinterpret_cast<const char*>(ASN1_STRING_get0_data(text));
  return {bytes, static_cast<std::size_t>(ASN1_STRING_length(text))};
}

/// RFC 5280: minimum is 0, and maximum absent. OpenSSL takes no other.
bool HasRange(const GENERAL_SUBTREE& subtree) {
  return subtree.maximum != nullptr ||
         (subtree.minimum != nullptr && ASN1_INTEGER_get(subtree.minimum) != 0);
}

/// The hosts of the constraints on URIs; false if one of them has a range.
bool TakeHosts(const STACK_OF(GENERAL_SUBTREE) * subtrees, std::vector<std::string>& hosts) {
  for (int i = 0; i < sk_GENERAL_SUBTREE_num(subtrees); ++i) {
    const GENERAL_SUBTREE* subtree = sk_GENERAL_SUBTREE_value(subtrees, i);
    if (subtree->base->type != GEN_URI) continue;
    if (HasRange(*subtree)) return false;
    hosts.push_back(TextOf(subtree->base->d.uniformResourceIdentifier));
  }
  return true;
}

std::optional<std::string_view> HostOf(std::string_view uri) {
  constexpr std::string_view kAuthority = "://";
  const std::size_t at = uri.find(kAuthority);
  if (at == std::string_view::npos) return std::nullopt;
  uri.remove_prefix(at + kAuthority.size());
  const std::string_view authority = uri.substr(0, uri.find_first_of("/?#"));
  if (authority.find('@') != std::string_view::npos) return std::nullopt;
  const std::string_view host = authority.substr(0, authority.find(':'));
  if (host.empty()) return std::nullopt;
  return host;
}

/// Hosts are ASCII.
bool IsSame(std::string_view left, std::string_view right) {
  return std::ranges::equal(left, right, {}, absl::ascii_tolower, absl::ascii_tolower);
}

bool IsWithin(std::string_view host, std::string_view constraint) {
  if (!constraint.starts_with('.')) return IsSame(host, constraint);
  return host.size() > constraint.size() &&
         IsSame(host.substr(host.size() - constraint.size()), constraint);
}

bool IsWithinAny(std::string_view host, const std::vector<std::string>& constraints) {
  return std::ranges::any_of(
      constraints, [host](const std::string& constraint) { return IsWithin(host, constraint); });
}

}  // namespace

void UriConstraints::Add(const X509& authority) {
  int critical = 0;
  const Constraints constraints(static_cast<NAME_CONSTRAINTS*>(
      X509_get_ext_d2i(&authority, NID_name_constraints, &critical, nullptr)));
  ERR_clear_error();
  OfAuthority of;
  if (constraints == nullptr) {
    if (critical == -1) return;  // it has none
    of.unreadable = true;
  } else {
    of.unreadable = !TakeHosts(constraints->permittedSubtrees, of.permitted) ||
                    !TakeHosts(constraints->excludedSubtrees, of.excluded);
  }
  if (of.unreadable || !of.permitted.empty() || !of.excluded.empty()) {
    authorities_.push_back(std::move(of));
  }
}

bool UriConstraints::OfAuthority::Allow(std::string_view host) const {
  if (unreadable || IsWithinAny(host, excluded)) return false;
  return permitted.empty() || IsWithinAny(host, permitted);
}

bool UriConstraints::Allow(std::string_view uri) const {
  if (authorities_.empty()) return true;
  const std::optional<std::string_view> host = HostOf(uri);
  return host && std::ranges::all_of(authorities_, [&host](const OfAuthority& authority) {
           return authority.Allow(*host);
         });
}

}  // namespace uplink::identity
