#pragma once

#include <memory>

#include <absl/status/statusor.h>

#include "server/config/config.h"
#include "server/transport/listener.h"
#include "server/transport/options.h"

namespace uplink {

/// Listens for robots by the transport that the configuration names. Everything in `context`
/// outlives the listener.
///
/// Errors: kUnavailable names the address and why nobody can listen there; kFailedPrecondition
///         names what is wrong with certificate, key or authority.
/// Thread: main.
[[nodiscard]] absl::StatusOr<std::unique_ptr<transport::Listener>> ListenBy(
    const config::Config& config, const transport::RelayContext& context);

}  // namespace uplink
