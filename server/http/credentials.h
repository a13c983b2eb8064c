#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <absl/status/statusor.h>

#include "schema/base/clock.h"
#include "server/identity/deny_list.h"
#include "server/identity/peer_identity.h"

namespace uplink::http {

/// The certificate that a peer showed in its handshake. Immutable.
struct PeerCertificate {
  /// Not OK: why it shows nothing, for its peer.
  absl::StatusOr<identity::PeerIdentity> identity;
  std::string subject;
  /// When the first certificate of its chain expires.
  SystemTime expiry{};
  /// What a revocation may name.
  std::vector<identity::NamedCertificate> chain{};
};

/// The token of an Authorization header's value; nothing for another scheme, which shows us
/// nothing. A view of the header.
///
/// Source: RFC 6750, 2.1.
[[nodiscard]] std::optional<std::string_view> BearerToken(std::string_view authorization);

/// Whether a query has a parameter that is called as tokens are: addresses are kept by logs,
/// histories and proxies, where a token must not be.
///
/// Source: RFC 6750, 5.3.
[[nodiscard]] bool HasToken(std::string_view query);

}  // namespace uplink::http
