#pragma once

#include <string>
#include <vector>

#include <absl/status/status.h>

namespace uplink::pki {

/// Whether the relay looks into a Certificate message with these certificates, in DER, in the order
/// in which a client shows them: it turns away who shows others (server/identity).
///
/// Errors: kInvalidArgument names the rule that they break, and the bytes if these are too many.
/// Thread: pure; any thread.
[[nodiscard]] absl::Status CheckShown(const std::vector<std::string>& certificates);

}  // namespace uplink::pki
