#pragma once

#include <string>
#include <vector>

#include <absl/status/statusor.h>

#include "schema/base/clock.h"
#include "tools/pki/directory.h"

namespace uplink::pki {

/// A certificate of a folder, for people. A value.
struct Listed {
  /// Of its files.
  std::string name;
  /// `authority`, `server`, `robot`, `gateway`, `viewer`, `operator`, `admin`,
  /// `metrics`; `unknown` if the server would take it for nothing, and `why` says so.
  std::string kind;
  std::string why;
  std::string fleet;
  /// RURIs, or the hosts of a server.
  std::vector<std::string> names;
  std::string subject;
  std::string issuer;
  std::string serial;
  /// Of the certificate and of its public key, hexadecimal.
  std::string sha256;
  std::string key_sha256;
  SystemTime begins;
  SystemTime expires;
  /// Its key is beside it.
  bool has_key = false;
};

/// The first certificate of NAME.crt.
///
/// Errors: kNotFound and kPermissionDenied name the file; kFailedPrecondition what is wrong in it.
[[nodiscard]] absl::StatusOr<Listed> ReadListed(const Directory& directory,
                                                const std::string& name);

/// Names of the certificates of a folder, in order.
///
/// Errors: kNotFound if the folder cannot be read.
[[nodiscard]] absl::StatusOr<std::vector<std::string>> NamesIn(const Directory& directory);

}  // namespace uplink::pki
