#pragma once

#include <cstddef>
#include <string>

#include <absl/status/statusor.h>

#include "schema/base/clock.h"
#include "server/identity/pem_file.h"

namespace uplink::identity {

/// What handshakes are served with, as it can be compared with the files on disk. A value.
struct ServedPems {
  /// Of the server's certificate.
  SystemTime expiry;
  /// Of the whole texts, as `sha256sum` shows them. A new key has a new certificate.
  std::string certificate_sha256;
  std::string client_ca_sha256;
  /// Certificates in `client_ca`.
  std::size_t authorities = 0;

  friend bool operator==(const ServedPems&, const ServedPems&) = default;
};

/// Errors: kFailedPrecondition with the name of the certificate's text if that holds none.
/// Thread: pure; any thread.
[[nodiscard]] absl::StatusOr<ServedPems> ServedPemsOf(const NamedPem& certificate,
                                                      const NamedPem& client_ca);

}  // namespace uplink::identity
