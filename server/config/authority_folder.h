#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <absl/status/statusor.h>

#include "server/identity/authority_rules.h"

namespace uplink::config {

/// Authorities of one folder.
inline constexpr std::size_t kAuthoritiesMax = 64;

/// A file of lists of revoked certificates, and that of the authority that signs them.
struct AuthorityLists {
  std::string lists;
  std::string authority;
};

/// What identity.authorities holds. A value.
struct AuthorityFolder {
  /// The certificates of all authorities (PEM).
  std::string pems;
  identity::AuthorityRules rules;
  std::vector<AuthorityLists> lists;
};

/// Reads a folder of authorities: of each NAME.pem, and NAME.toml with what it may vouch for
/// (`roles`, `fleets`; one that is missing: all) and its `crl_file`, if any, from that folder.
/// Names that begin with a dot are passed over.
///
/// Errors: kFailedPrecondition names the file that is missing, cannot be read, has a flaw or may be
///         written by everybody.
/// Thread: any; blocks on the files.
[[nodiscard]] absl::StatusOr<AuthorityFolder> ReadAuthorityFolder(const std::string& folder);

}  // namespace uplink::config
