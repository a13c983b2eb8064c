#pragma once

#include <string>

#include <absl/status/statusor.h>

#include "schema/base/clock.h"

namespace uplink::identity {

/// One PEM text and how a sentence names it: a path, or what it is.
struct NamedPem {
  std::string name;
  std::string text;
};

/// Bytes of the largest PEM file that is read: some thousand certificates.
inline constexpr std::size_t kPemBytesMax = std::size_t{4} * 1024 * 1024;

/// Errors: kFailedPrecondition if the file cannot be read, or is larger than kPemBytesMax.
/// Thread: any; blocks on the file.
[[nodiscard]] absl::StatusOr<NamedPem> ReadPem(const std::string& path);

/// Whether a TLS server can serve with the two: the certificate is one that a server may show, and
/// the key is its own.
///
/// Errors: kFailedPrecondition with a sentence that names the one that is invalid.
/// Thread: pure; any thread, as that below.
[[nodiscard]] absl::Status CheckServerPair(const NamedPem& certificate, const NamedPem& key);

/// Whether a TLS client can show the certificate: the key is its own. What it may be used for says
/// whoever it is shown to.
///
/// Errors: as CheckServerPair.
[[nodiscard]] absl::Status CheckClientPair(const NamedPem& certificate, const NamedPem& key);

/// When the first certificate of the text expires.
///
/// Errors: kFailedPrecondition with the name if there is none.
[[nodiscard]] absl::StatusOr<SystemTime> ExpiryOf(const NamedPem& certificate);

}  // namespace uplink::identity
