#pragma once

#include <absl/status/statusor.h>

#include "tools/link/http_client.h"
#include "tools/uplinkctl/doctor/finding.h"

namespace uplink::ctl {

/// What a running server says of itself: its answer to /readyz. A pure function.
[[nodiscard]] Finding ServerFinding(const absl::StatusOr<link::HttpAnswer>& answer);

}  // namespace uplink::ctl
