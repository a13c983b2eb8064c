#pragma once

#include <string>
#include <vector>

#include <absl/status/status.h>

#include "tools/uplink-fleet/robot/swarm.h"

namespace uplink::synthetic {

/// What `--client` may name: the clients that this build has.
[[nodiscard]] std::vector<std::string> ClientNames();

/// What `--protocol` may name, and the one by which drones speak, if this build has it.
inline constexpr const char* kRelayProtocol = "uplink";
inline constexpr const char* kDroneProtocol = "uncrew";
[[nodiscard]] std::vector<std::string> ProtocolNames();

/// Has the robots speak by this client.
///
/// Errors: kInvalidArgument names what the client cannot do and the run asks for.
[[nodiscard]] absl::Status UseClient(const std::string& name, SwarmOptions& swarm);

}  // namespace uplink::synthetic
