#pragma once

#include <cstdint>

#include <absl/status/status.h>

#include "schema/model/ids.h"
#include "server/session/frame_view.h"
#include "server/session/limits.h"

namespace uplink::session {

/// Checks a whole batch before any message of it is processed: the count; and the numbers, which
/// must be in range, increase strictly within the stream, and jump by at most kSeqJumpMax, except
/// at the stream's first message.
///
/// `last_seq` is the stream's last number, 0 before the first; `frame` its frame's number from 1.
/// Errors:  kInvalidArgument that names frame, field and rule.
/// Thread:  pure; any thread.
[[nodiscard]] absl::Status CheckBatch(const BatchView& batch, model::Seq last_seq,
                                      const SessionLimits& limits, std::uint64_t frame);

}  // namespace uplink::session
