#pragma once

#include <string>

#include <absl/status/statusor.h>

#include "schema/base/clock.h"
#include "server/identity/pem_file.h"

namespace uplink::identity {

/// The expiry of a certificate that never expires: 9999-12-31T23:59:59Z.
///
/// Source: RFC 5280, 4.1.2.5.
inline constexpr SystemTime kNoExpiry = FromUnixMs(253'402'300'799'000);

/// When the first certificate of the text expires; kNoExpiry at the latest.
///
/// Errors: kFailedPrecondition as of ReadCertificates (pem.h).
/// Thread: pure; any thread, as below.
[[nodiscard]] absl::StatusOr<SystemTime> ExpiryOf(const NamedPem& certificate);

/// ExpiryOf the text of a PEM file.
///
/// Errors: also if the file cannot be read; they name it.
[[nodiscard]] absl::StatusOr<SystemTime> ExpiryOfFile(const std::string& pem_file);

/// Text for the log: `2026-12-31T23:59:59Z`, or `never` for kNoExpiry.
[[nodiscard]] std::string ExpiryText(SystemTime expiry);

}  // namespace uplink::identity
