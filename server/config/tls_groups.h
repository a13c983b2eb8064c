#pragma once

#include <optional>
#include <string>
#include <vector>

#include "server/config/config.h"

namespace uplink::config {

/// Why `tls.groups` cannot be these, as the end of a sentence; nothing if it can.
///
/// Thread: pure; any thread.
[[nodiscard]] std::optional<std::string> FlawOfGroups(const std::vector<std::string>& groups);

/// The groups by which the relay agrees on keys, in order, as OpenSSL reads them
/// (`X25519:P-256`): those of `tls.groups`, and where TLS 1.2 is accepted P-384 and P-521 behind
/// them, because by TLS 1.2 OpenSSL takes no client certificate on a curve that is not among them.
///
/// Source: RFC 8422, 5.1; tls12_check_peer_sigalg in OpenSSL's ssl/t1_lib.c. Thread: pure.
[[nodiscard]] std::string ServedGroups(const TlsConfig& tls);

}  // namespace uplink::config
