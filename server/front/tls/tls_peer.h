#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <string>

#include <absl/status/statusor.h>
#include <openssl/types.h>

#include "schema/base/clock.h"
#include "server/identity/authority_rules.h"
#include "server/identity/peer_identity.h"
#include "server/identity/shown_certificate.h"

namespace uplink::front {

/// Times further away than this count as never, since they would not fit the clock's numbers.
inline constexpr std::chrono::hours kFarAway{24 * 365 * 10};

/// The peer that a finished handshake has shown. A value.
struct TlsPeer {
  /// It has shown no certificate.
  bool anonymous = false;
  /// Not OK: what is wrong with the certificate; its peer is told, and not served.
  absl::StatusOr<identity::PeerIdentity> identity;
  /// The RURI in its certificate, if any, even if it has expired.
  std::string ruri;
  /// The same for a gateway: its certificate's subject.
  std::string gateway = {};
  /// The same for a certificate that names neither a robot nor a gateway: its subject.
  std::string subject = {};
  /// SHA-256 of its public key; without a certificate KeyOf its source.
  std::array<std::uint8_t, 32> key{};
  /// When the first certificate of its chain expires.
  SystemTime expiry;
  /// For lists of connections.
  identity::ShownCertificate certificate = {};
  /// Its authority may not vouch for its role or fleet: the identity says so.
  bool outside_authority = false;

  [[nodiscard]] bool IsGateway() const {
    return identity.ok() && identity->role == identity::Role::kGateway;
  }
  /// Several programs may come by its key: a gateway's, or an operator's; or it has none.
  [[nodiscard]] bool SharesItsKey() const {
    return anonymous || (identity.ok() && identity->role != identity::Role::kRobot);
  }
  /// The remaining life of its chain, at most kFarAway; kFarAway if the identity is bad or the
  /// clock is not vouched for.
  [[nodiscard]] milliseconds UntilExpiry(SystemTime now, bool vouched) const;
  /// Spreads robots with different keys evenly.
  [[nodiscard]] std::uint16_t jitter() const {
    return static_cast<std::uint16_t>(key[0] * 256 + key[1]);
  }
};

/// The peer of a finished handshake. `verify_error`: the flaw of its trusted chain, an
/// X509_V_ERR_...; X509_V_OK for none. `authorities`: what its authority may vouch for.
[[nodiscard]] TlsPeer PeerOf(const SSL* connection, int verify_error,
                             const identity::AuthorityRules& authorities);

}  // namespace uplink::front
