#pragma once

#include <string>

#include <absl/status/status.h>
#include <openssl/types.h>

#include "server/identity/pem_blocks.h"

namespace uplink::identity {

// Checks for keys and signatures that are too weak for OpenSSL. Its security level sets the bound.
// The level is 2 unless the library's build or its openssl.cnf sets another: RSA from 2,048 bits
// on, and no SHA-1.

/// Why the key of an authority is too weak, so that no certificate it signed would be trusted.
/// Empty if it is strong enough.
///
/// Thread: pure; any thread, as that below.
[[nodiscard]] std::string WeaknessOf(X509& authority);

/// Whether a TLS server or client may show this chain and use this key. Both must be readable.
///
/// Errors: kFailedPrecondition with the one that OpenSSL refuses, and OpenSSL's reason.
[[nodiscard]] absl::Status CheckStrength(const NamedPem& certificate, const NamedPem& key);

}  // namespace uplink::identity
