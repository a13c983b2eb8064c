#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <absl/status/statusor.h>
#include <openssl/types.h>

#include "server/identity/uri_constraints.h"

namespace uplink::identity {

/// What a certificate's subject says its holder is (protocol: Certificates). Closed.
enum class Role : std::uint8_t { kRobot, kGateway, kViewer, kOperator, kAdmin };

[[nodiscard]] std::string_view ToText(Role role);

/// Bytes of a subject that are kept; a longer one is cut.
inline constexpr std::size_t kSubjectBytesMax = 256;

/// Who stands behind a verified client certificate. Immutable after it was made.
struct PeerIdentity {
  Role role = Role::kRobot;
  /// Subject O; `default` if the certificate has none. `*` for operators that may see all fleets.
  std::string fleet;
  /// The RURIs of the certificate: exactly one for a robot, none or several for a gateway, none for
  /// the others.
  std::vector<std::string> ruris;
  /// Of a gateway, whom its robots, bounds and log lines name: the subject of its certificate, at
  /// most kSubjectBytesMax. Empty of all others.
  std::string subject = {};
  /// Of a gateway: what the authorities of its chain allow in URI names.
  UriConstraints constraints = {};

  /// A gateway may speak for this robot of its fleet: its certificate names the robot, or none, and
  /// its authorities may sign for the robot.
  [[nodiscard]] bool MaySpeakFor(std::string_view ruri) const {
    return (ruris.empty() || Names(ruri)) && constraints.Allow(ruri);
  }
  /// The certificate names this robot.
  [[nodiscard]] bool Names(std::string_view ruri) const {
    return std::ranges::find(ruris, ruri) != ruris.end();
  }
  /// The RURI of a robot's certificate.
  [[nodiscard]] const std::string& ruri() const { return ruris.front(); }
};

/// The identity of a certificate that the TLS layer has verified, and holds. Reading its extensions
/// caches them in it.
///
/// Errors: kUnauthenticated with a sentence of its own for each way to be wrong; it repeats no more
///         of the certificate than the invalid part, printable and cut.
/// Thread: that of the certificate's connection.
[[nodiscard]] absl::StatusOr<PeerIdentity> IdentityOf(X509& certificate);

/// The subject as one line (RFC 2253), at most kSubjectBytesMax; empty if the library cannot print
/// it.
[[nodiscard]] std::string SubjectOf(const X509& certificate);

}  // namespace uplink::identity
