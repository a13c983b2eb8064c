#pragma once

#include <string>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "schema/base/clock.h"

namespace uplink::health {

/// What the relay's certificate files say now. A value.
struct CertificateLook {
  /// Of the first certificate.
  SystemTime expiry;
  /// Not OK while certificate and key do not fit, as between the two steps of a renewal: gRPC
  /// serves no new connection then.
  absl::Status pair;
};

/// Looks at the files.
///
/// Errors: kFailedPrecondition naming the file, if the certificate cannot be read or holds none.
[[nodiscard]] absl::StatusOr<CertificateLook> LookAtCertificate(const std::string& certificate_file,
                                                                const std::string& key_file);

}  // namespace uplink::health
