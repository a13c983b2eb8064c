#pragma once

#include <string>

#include <absl/status/status.h>

#include "server/log/rate_limited.h"

namespace uplink::transport {

/// A line about a stream that ends since it was refused (`stream_refused`) or broke a rule of the
/// protocol (`protocol_error`); none for another end, or without `lines`. Thread-safe.
void LogRefusal(log::RateLimited* lines, const std::string& peer, const std::string& robot,
                const absl::Status& status);

}  // namespace uplink::transport
