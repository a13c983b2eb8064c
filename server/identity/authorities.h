#pragma once

#include <cstddef>

#include <absl/status/status.h>

#include "server/identity/server_pair.h"

namespace uplink::identity {

/// Blocks of one text that are named, if they have no use; the others are counted.
inline constexpr std::size_t kRefusedNamedMax = 8;

/// Whether every certificate of the text can be read, and is one that robots may show too
/// (FlawOfCertificate). TLS libraries stop at the first that cannot, or pass over a block whose
/// first line is damaged or missing, and say nothing: robots of that authority, or of those behind
/// it, would be strangers. Blocks of other kinds, and text between blocks, count for nothing.
///
/// Errors: kFailedPrecondition with the name, and the number, the line and what is wrong of every
///         block without a use; also if there is no certificate at all.
/// Limits: kRefusedNamedMax.
/// Thread: pure; any thread.
[[nodiscard]] absl::Status CheckAuthorities(const NamedPem& authorities);

}  // namespace uplink::identity
