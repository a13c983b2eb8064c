#pragma once

#include <cstddef>
#include <cstdint>

#include <absl/status/status.h>

#include "server/transport/end_cause.h"

namespace uplink::session {

// The statuses with which the server ends streams, where they are not those of a Hello or a batch.

/// The server drains, or the connection does.
[[nodiscard]] absl::Status Drained();
[[nodiscard]] absl::Status NotSettled();
[[nodiscard]] absl::Status FrameTooLarge(std::uint64_t frame, std::uint64_t bytes,
                                         std::uint64_t bytes_max);
/// The agent read nothing for kPeerStallMax, while so many frames waited.
[[nodiscard]] absl::Status ReadNothing(std::size_t frames);

/// Why a stream ends whose session could not be opened (Attachment::Open).
[[nodiscard]] transport::EndCause CauseOfRefusal(const absl::Status& status);

}  // namespace uplink::session
