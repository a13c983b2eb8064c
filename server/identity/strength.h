#pragma once

#include <string>

#include <absl/status/status.h>
#include <openssl/types.h>

#include "server/identity/pem_blocks.h"

namespace uplink::identity {

/// Keys and signatures that are too weak for OpenSSL. How strong they must be is its security
/// level: 2 unless whoever built or runs the library says otherwise, so RSA of 2,048 bits and no
/// SHA-1.

/// What is wrong with an authority's key: no certificate behind it is trusted. Empty if it is
/// strong enough.
///
/// Thread: any; pure, as that below.
[[nodiscard]] std::string WeaknessOf(X509& authority);

/// Whether a TLS server or client may show this chain, and use this key, both of which can be read.
///
/// Errors: kFailedPrecondition with the one that OpenSSL refuses, and its words for why.
[[nodiscard]] absl::Status CheckStrength(const NamedPem& certificate, const NamedPem& key);

}  // namespace uplink::identity
