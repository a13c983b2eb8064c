#pragma once

#include <optional>
#include <string>

#include <absl/status/statusor.h>

#include "schema/base/clock.h"
#include "server/mqtt/settings.h"

namespace uplink::mqtt {

/// The PEM texts of a TLS connection; empty if the settings name no file. A value.
struct TlsTexts {
  std::string ca;
  std::string certificate;
  std::string key;
};

/// The contents of the settings' files. A value; never logged.
struct Secrets {
  std::optional<std::string> password;
  TlsTexts tls;
};

/// Reads the files, for one connection: they may have changed since the last one.
///
/// Errors:  kFailedPrecondition names the key of the configuration and the file: it cannot be read,
///          is too large (kPasswordBytesMax, identity::kPemBytesMax), is empty, every user may
///          write it, or a start would refuse it too (CheckAuthorities, CheckClientPair).
/// Thread:  any; blocks on the files.
[[nodiscard]] absl::StatusOr<Secrets> ReadSecrets(const ClientSettings& settings);

/// When the client's certificate expires, by its file now; empty without one.
///
/// Errors and thread: as ReadSecrets.
[[nodiscard]] absl::StatusOr<std::optional<SystemTime>> CertificateExpiry(
    const ClientSettings& settings);

}  // namespace uplink::mqtt
