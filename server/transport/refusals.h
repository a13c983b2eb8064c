#pragma once

#include <string>
#include <string_view>

#include <absl/status/status.h>

#include "server/log/rate_limited.h"

namespace uplink::transport {

/// The event of a line about a stream that ends with this status: `stream_refused`, or
/// `protocol_error` if it broke a rule of the protocol; empty for another end.
[[nodiscard]] std::string_view RefusalEvent(const absl::Status& status);

/// That line; none without `lines`. Thread-safe.
void LogRefusal(log::RateLimited* lines, const std::string& peer, const std::string& robot,
                const absl::Status& status);

}  // namespace uplink::transport
