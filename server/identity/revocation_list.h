#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <absl/status/statusor.h>

#include "schema/base/clock.h"
#include "server/identity/pem_file.h"
#include "server/identity/shown_certificate.h"

namespace uplink::identity {

/// Lists of one file.
inline constexpr std::size_t kRevocationListsMax = 64;

/// What an authority has taken back (a CRL). A value.
struct RevocationList {
  std::string issuer;
  /// Of certificates that the key which signed the list has signed too.
  std::vector<SignedSerial> revoked;
  /// When the authority promised the next list; nothing: it did not.
  std::optional<SystemTime> next_update;
};

/// The lists of a file: one in DER, or one or more in PEM. Each is signed by one of the
/// authorities, whose certificate allows that (cRLSign, if it names key usages). A list whose next
/// update is over counts all the same.
///
/// Errors: kFailedPrecondition names the file, and which list cannot be used: it cannot be read, no
///         authority signed it, or it is one that tells only a part (a delta or an indirect list, a
///         critical extension that we do not know).
/// Limits: kRevocationListsMax; storage::kRevocationsMax certificates.
/// Thread: pure; any thread. Source: RFC 5280, 5.
[[nodiscard]] absl::StatusOr<std::vector<RevocationList>> ReadRevocationLists(
    const NamedPem& file, const NamedPem& authorities);

}  // namespace uplink::identity
