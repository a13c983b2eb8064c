#pragma once

#include <absl/status/status.h>

#include "server/identity/pem_file.h"

namespace uplink::identity {

/// Whether the text holds certificates that can be read, every one of them.
///
/// Errors: kFailedPrecondition as of ReadCertificates (pem.h).
/// Thread: pure; any thread, as those below.
[[nodiscard]] absl::Status CheckCertificates(const NamedPem& certificates);

/// Whether the text holds one private key that can be read.
///
/// Errors: kFailedPrecondition as of ReadKey (pem.h).
[[nodiscard]] absl::Status CheckKey(const NamedPem& key);

/// Whether a TLS server can serve with the two: the first certificate is one that a server may
/// show, the key is its own, and of a kind with which a TLS server signs; nothing is too weak
/// (CheckStrength).
///
/// Errors: kFailedPrecondition with a sentence that names the one that is invalid; as of
///         CheckCertificates and CheckKey, too.
[[nodiscard]] absl::Status CheckServerPair(const NamedPem& certificate, const NamedPem& key);

/// Whether a TLS client can show the certificate: the key is its own, and nothing is too weak.
/// Which use it must allow is for the server to say.
///
/// Errors: as CheckServerPair.
[[nodiscard]] absl::Status CheckClientPair(const NamedPem& certificate, const NamedPem& key);

}  // namespace uplink::identity
