#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace uplink::http {

/// Why a request, or a connection, was not served: its caller shows not who it is, or may not ask.
/// Closed.
enum class Denied : std::uint8_t {
  /// It shows neither a token nor a certificate.
  kNoProof,
  kBadToken,
  kExpiredToken,
  kBadCertificate,
  /// Its role may not ask that.
  kRole,
  /// It asks about the whole server, and may see some fleets.
  kScope,
  /// Its source failed too often.
  kTooMany,
  /// It speaks without TLS and is not in http.plain_from.
  kPlain,
  /// It gives more commands than admin::CommandRate lets through.
  kRate,
};

/// As metric labels and in logs, by Denied.
inline constexpr std::array<std::string_view, 9> kDeniedTexts = {
    "no_proof", "bad_token", "expired_token", "bad_certificate", "role", "scope",
    "too_many", "plain",     "rate"};
static_assert(kDeniedTexts.size() == static_cast<std::size_t>(Denied::kRate) + 1);

[[nodiscard]] constexpr std::string_view ToText(Denied why) {
  return kDeniedTexts[static_cast<std::size_t>(why)];
}

}  // namespace uplink::http
