#pragma once

#include <cstddef>
#include <string>

#include <absl/status/statusor.h>

#include "schema/base/clock.h"
#include "server/identity/pem_file.h"

namespace uplink::identity {

/// The PEM texts that handshakes use, in a form to compare with the files on disk. A value.
struct ServedPems {
  /// When the server's certificate expires.
  SystemTime expiry;
  /// Of the whole texts, as `sha256sum` shows them. There is none of the key: a new key has a new
  /// certificate.
  std::string certificate_sha256;
  std::string client_ca_sha256;
  /// How many certificates `client_ca` has.
  std::size_t authorities = 0;

  friend bool operator==(const ServedPems&, const ServedPems&) = default;
};

/// Errors: those of ExpiryOf for `certificate`. A `client_ca` that cannot be read counts 0.
/// Thread: pure; any thread.
[[nodiscard]] absl::StatusOr<ServedPems> ServedPemsOf(const NamedPem& certificate,
                                                      const NamedPem& client_ca);

}  // namespace uplink::identity
