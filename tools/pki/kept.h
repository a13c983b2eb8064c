#pragma once

#include <optional>
#include <string>
#include <vector>

#include <absl/status/status.h>

#include "schema/base/clock.h"
#include "tools/pki/directory.h"
#include "tools/pki/profile.h"

namespace uplink::pki {

/// What a pair that is already there must be, to stay instead of a new one.
struct Wanted {
  /// Certificate of the authority that signed it; empty for an authority's own pair.
  std::string authority_pem;
  /// It is a server's, and clients dial it by these names; none: it is no server's.
  std::vector<std::string> hosts;
  /// It is a robot's, gateway's or operator's, and says this.
  std::optional<Profile> client;
};

/// Whether the pair `name` of the folder can be used as if it had been made now: the key belongs to
/// the certificate, its owner alone may read and write the key, the authority signed it, it has not
/// expired, it is of the wanted kind and names the hosts, or says what the profile of a client
/// says.
///
/// Errors: kFailedPrecondition names the file, what is wrong and what to do; those of
///         Directory::Read.
/// Thread: any; reads the two files.
[[nodiscard]] absl::Status CheckKept(const Directory& directory, const std::string& name,
                                     const Wanted& wanted, SystemTime now);

}  // namespace uplink::pki
