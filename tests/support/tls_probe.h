#pragma once

#include <cstdint>
#include <string>

namespace uplink::testing {

/// Begins a TLS handshake with a listener on loopback, offering at most `version_max` (an OpenSSL
/// constant such as TLS1_2_VERSION), without a client certificate. Returns the version of the
/// ServerHello (`TLSv1.2`); empty if none came: the server refused what was offered.
[[nodiscard]] std::string AgreedTlsVersion(std::uint16_t port, int version_max);

}  // namespace uplink::testing
