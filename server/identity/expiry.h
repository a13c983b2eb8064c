#pragma once

#include <absl/status/statusor.h>

#include "schema/base/clock.h"
#include "server/identity/pem_file.h"

namespace uplink::identity {

/// When the first certificate of the text expires.
///
/// Errors: kFailedPrecondition as of ReadCertificates (pem.h).
/// Thread: pure; any thread.
[[nodiscard]] absl::StatusOr<SystemTime> ExpiryOf(const NamedPem& certificate);

}  // namespace uplink::identity
