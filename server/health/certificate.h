#pragma once

#include <string>

#include <absl/status/statusor.h>

#include "schema/base/clock.h"

namespace uplink::health {

/// When the first certificate of a PEM file expires.
///
/// Errors: kFailedPrecondition naming the file, if it cannot be read or holds none.
[[nodiscard]] absl::StatusOr<SystemTime> CertificateExpiry(const std::string& pem_file);

}  // namespace uplink::health
