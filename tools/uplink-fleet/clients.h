#pragma once

#include <string>
#include <vector>

#include <absl/status/status.h>

#include "tools/uplink-fleet/robot/swarm.h"

namespace uplink::synthetic {

/// What `--client` may name: the clients that this build has.
[[nodiscard]] std::vector<std::string> ClientNames();

/// Has the robots speak by this client.
///
/// Errors: kInvalidArgument names what the client cannot do and the run asks for.
[[nodiscard]] absl::Status UseClient(const std::string& name, SwarmOptions& swarm);

}  // namespace uplink::synthetic
