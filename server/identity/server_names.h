#pragma once

#include <string>
#include <vector>

#include <absl/status/statusor.h>

#include "server/identity/pem_file.h"

namespace uplink::identity {

/// The hosts for which the first certificate of the text is made out: DNS names and IP addresses of
/// its subjectAltName, in their order. Clients ignore every other name. Empty if there are none.
///
/// Errors: kFailedPrecondition as of ReadCertificates (pem.h).
/// Thread: pure; any thread.
[[nodiscard]] absl::StatusOr<std::vector<std::string>> ServerNamesOf(const NamedPem& certificate);

}  // namespace uplink::identity
