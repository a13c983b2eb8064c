#pragma once

#include <string>

#include <absl/status/status.h>
#include <openssl/types.h>

#include "server/identity/pem_blocks.h"

namespace uplink::identity {

// Keys and signatures that are too weak for OpenSSL. Its security level says how strong they must
// be. That is 2 unless the library's build or its openssl.cnf says otherwise: RSA from 2,048 bits
// on, and no SHA-1.

/// What is wrong with the key of an authority that is too weak: no certificate behind it would be
/// trusted. Empty if it is strong enough.
///
/// Thread: pure; any thread, as that below.
[[nodiscard]] std::string WeaknessOf(X509& authority);

/// Whether a TLS server or client may show this chain, and use this key, both of which can be read.
///
/// Errors: kFailedPrecondition with the one that OpenSSL refuses, and its words for why.
[[nodiscard]] absl::Status CheckStrength(const NamedPem& certificate, const NamedPem& key);

}  // namespace uplink::identity
