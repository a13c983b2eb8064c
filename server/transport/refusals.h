#pragma once

#include <string>
#include <string_view>

#include <absl/status/status.h>

#include "server/log/rate_limited.h"

namespace uplink::transport {

/// The event of a line about a stream that ends with this status: `stream_refused`, or
/// `protocol_error` if it broke a rule of the protocol; of a stream that came through `gateway`
/// also `stream_superseded`, since two that speak for one robot are hard to find; empty for another
/// end.
[[nodiscard]] std::string_view RefusalEvent(const absl::Status& status,
                                            std::string_view gateway = {});

/// Whose stream it was. A value.
struct RefusedPeer {
  std::string peer;
  std::string robot;
  std::string gateway = {};
};

/// That line; none without `lines`. Thread-safe.
void LogRefusal(log::RateLimited* lines, const RefusedPeer& peer, const absl::Status& status);

}  // namespace uplink::transport
