#include "server/transport/methods.h"

#include <algorithm>

#include <fmt/format.h>

namespace uplink::transport {
namespace {

absl::Status WrongRole(identity::Role role, std::string_view audience) {
  return absl::UnauthenticatedError(
      fmt::format("the certificate is of role {}; {}", identity::ToText(role), audience));
}

}  // namespace

absl::Status MayCall(const absl::StatusOr<identity::PeerIdentity>& identity, const Methods& methods,
                     std::string_view path) {
  const auto found = methods.find(path);
  const auto is_open = [](const Methods::value_type& method) { return method.second.open; };
  if (found != methods.end() ? is_open(*found)
                             : std::any_of(methods.begin(), methods.end(), is_open)) {
    return absl::OkStatus();
  }
  if (!identity.ok()) return identity.status();
  const auto takes = [role = identity->role](const Methods::value_type& method) {
    const auto& roles = method.second.roles;
    return std::find(roles.begin(), roles.end(), role) != roles.end();
  };
  if (found != methods.end()) {
    return takes(*found) ? absl::OkStatus() : WrongRole(identity->role, found->second.audience);
  }
  // Other roles do not learn which methods exist.
  if (std::any_of(methods.begin(), methods.end(), takes)) return absl::OkStatus();
  return WrongRole(identity->role, "nothing here takes it");
}

}  // namespace uplink::transport
