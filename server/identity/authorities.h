#pragma once

#include <absl/status/status.h>

#include "server/identity/pem_blocks.h"

namespace uplink::identity {

/// Whether every certificate of the text can be read, is one that robots may show too
/// (FlawOfCertificate), and has a key that is strong enough (WeaknessOf). A broken one is not
/// passed over: robots of that authority, or of those behind it, would be strangers.
///
/// Errors: kFailedPrecondition as of ReadCertificates (pem.h), with every block without a use and
///         what is wrong with it, also of those that robots may not show.
/// Limits: kRefusedNamedMax.
/// Thread: pure; any thread.
[[nodiscard]] absl::Status CheckAuthorities(const NamedPem& authorities);

}  // namespace uplink::identity
