#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include <absl/status/statusor.h>
#include <openssl/types.h>

#include "server/identity/fleet_bounds.h"
#include "server/identity/gateway.h"

namespace uplink::identity {

/// The role of a certificate's holder, from its subject (protocol: Certificates). Closed.
enum class Role : std::uint8_t { kRobot, kGateway, kViewer, kOperator, kAdmin, kMetrics };
/// The roles of people and programs that ask. A metrics role scrapes, and no more.
inline constexpr std::array<Role, 4> kAskingRoles = {Role::kViewer, Role::kOperator, Role::kAdmin,
                                                     Role::kMetrics};

[[nodiscard]] std::string_view ToText(Role role);
/// One of kAskingRoles; nothing for any other text.
[[nodiscard]] std::optional<Role> AskingRoleOf(std::string_view text);

/// Bytes of a subject that are kept; a longer one is cut.
inline constexpr std::size_t kSubjectBytesMax = 256;

/// The holder of a verified client certificate. Immutable once made.
struct PeerIdentity {
  Role role = Role::kRobot;
  /// Subject O; `default` if the certificate has none. `*` for operators that may see all fleets.
  std::string fleet;
  /// The RURI of a robot's certificate; empty of all others.
  std::string ruri = {};
  /// Of a gateway; empty of all others.
  Gateway gateway = {};
  /// Of the authority that vouches for it, as the handshake found its entry.
  FleetBoundsPtr bounds = {};
};

/// The identity in a certificate that the TLS layer has verified and owns. Reading the extensions
/// caches them in the certificate.
///
/// Errors: kUnauthenticated with a different sentence for each flaw; it repeats only the invalid
///         part of the certificate, printable and cut.
/// Thread: that of the certificate's connection.
[[nodiscard]] absl::StatusOr<PeerIdentity> IdentityOf(X509& certificate);

/// The subject as one line (RFC 2253), at most kSubjectBytesMax; empty if the library cannot print
/// it.
[[nodiscard]] std::string SubjectOf(const X509& certificate);

}  // namespace uplink::identity
