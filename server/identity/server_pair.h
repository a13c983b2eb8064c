#pragma once

#include <absl/status/status.h>

#include "server/identity/pem_file.h"

namespace uplink::identity {

/// Whether the text holds certificates, and all of them can be read.
///
/// Errors: kFailedPrecondition as of ReadCertificates (pem.h).
/// Thread: pure; any thread, as those below.
[[nodiscard]] absl::Status CheckCertificates(const NamedPem& certificates);

/// Whether the text holds one private key that can be read.
///
/// Errors: kFailedPrecondition as of ReadKey (pem.h).
[[nodiscard]] absl::Status CheckKey(const NamedPem& key);

/// Whether a TLS server can use the two: the first certificate is one for servers, the key belongs
/// to it and is of a kind with which a TLS server signs, and nothing is too weak
/// (CheckStrength).
///
/// Errors: those of CheckCertificates, CheckKey and CheckStrength; kFailedPrecondition with a
///         sentence that names the invalid one.
[[nodiscard]] absl::Status CheckServerPair(const NamedPem& certificate, const NamedPem& key);

/// Whether a TLS client can show the certificate: the key belongs to it, and nothing is too weak.
/// Which extended key usage it needs is up to the server.
///
/// Errors: as CheckServerPair.
[[nodiscard]] absl::Status CheckClientPair(const NamedPem& certificate, const NamedPem& key);

}  // namespace uplink::identity
