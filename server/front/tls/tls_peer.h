#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <string>

#include <absl/status/statusor.h>
#include <openssl/types.h>

#include "schema/base/clock.h"
#include "server/identity/peer_identity.h"

namespace uplink::front {

/// Further away than this is never: times beyond would not fit the clock's numbers.
inline constexpr std::chrono::hours kFarAway{24 * 365 * 10};

/// Whom a finished handshake has shown. A value.
struct TlsPeer {
  /// Not OK: what the certificate lacks; whoever shows it is told, and not served.
  absl::StatusOr<identity::PeerIdentity> identity;
  /// The name that its certificate has, if it has one, though it may have expired.
  std::string ruri;
  /// The subject of a gateway's, the same.
  std::string gateway = {};
  /// The subject of one that is neither a robot's nor a gateway's.
  std::string subject = {};
  /// SHA-256 of its public key.
  std::array<std::uint8_t, 32> key{};
  /// When the first certificate of its chain expires.
  SystemTime expiry;

  [[nodiscard]] bool IsGateway() const {
    return identity.ok() && identity->role == identity::Role::kGateway;
  }
  /// What is left of its chain, at most kFarAway; kFarAway if the identity is bad or the clock is
  /// not vouched for.
  [[nodiscard]] milliseconds UntilExpiry(SystemTime now, bool vouched) const;
  /// Spreads what robots with different keys do, evenly.
  [[nodiscard]] std::uint16_t jitter() const {
    return static_cast<std::uint16_t>(key[0] * 256 + key[1]);
  }
};

/// Who is there, by what a finished handshake has shown. `verify_error`: what its trusted chain
/// lacks, an X509_V_ERR_...; X509_V_OK for nothing.
[[nodiscard]] TlsPeer PeerOf(const SSL* connection, int verify_error);

}  // namespace uplink::front
