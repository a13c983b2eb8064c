#pragma once

#include <string_view>

#include <absl/status/status.h>
#include <openssl/types.h>

#include "server/transport/options.h"

/// What the TLS of all our listeners has in common.
namespace uplink::transport {

/// Versions, suites and groups by the rules; no tickets and no session cache, since each handshake
/// shows its certificate anew; and buffers that an idle connection gives back. False if the library
/// has none of the suites or groups.
[[nodiscard]] bool SetProtocol(SSL_CTX* context, const TlsRules& rules);

/// Trusts the authorities of a PEM text, also one that another has signed, and tells clients their
/// names. False if one cannot be read or is refused.
[[nodiscard]] bool TrustAuthorities(SSL_CTX* context, std::string_view text);

/// Whether a chain with this X509_V_ERR_... is still one that our authorities signed.
[[nodiscard]] bool IsTrusted(int verify_error, int depth);

/// The message to the peer of a trusted chain with this X509_V_ERR_....
[[nodiscard]] absl::Status FlawOfTrusted(int verify_error);

}  // namespace uplink::transport
