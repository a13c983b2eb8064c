#pragma once

#include <absl/status/status.h>

#include "server/identity/pem_blocks.h"

namespace uplink::identity {

/// Whether every certificate of the text can be read, is one that robots may show too
/// (FlawOfCertificate), and has a key that is strong enough (WeaknessOf). A broken one is an error:
/// without it, robots of that authority, or of one that it signed, would be refused.
///
/// Errors: as ReadCertificates (pem.h), naming each block that cannot be used and what is wrong
///         with it, also each certificate that robots may not show.
/// Limits: kRefusedNamedMax.
/// Thread: pure; any thread.
[[nodiscard]] absl::Status CheckAuthorities(const NamedPem& authorities);

}  // namespace uplink::identity
