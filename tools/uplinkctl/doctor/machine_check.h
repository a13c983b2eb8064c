#pragma once

#include <cstddef>
#include <optional>

#include "server/config/config.h"
#include "tools/uplinkctl/doctor/finding.h"
#include "tools/uplinkctl/doctor/machine_facts.h"
#include "tools/uplinkctl/listeners.h"

namespace uplink::ctl {

/// Descriptors beside those of robots: peers without a certificate, the store, HTTP
/// (docs/operate/capacity.md).
inline constexpr std::size_t kDescriptorsBeside = 6'144;
/// Connections of load balancers that have not yet said for whom they are.
inline constexpr std::size_t kDescriptorsOfProxies = 1'024;

/// The uplinkd that listens there, if one does: by its sockets, or, where these cannot be seen, by
/// the user who owns the socket. All here are pure functions.
[[nodiscard]] std::optional<ServerProcess> ServerAt(const config::ListenAddress& address,
                                                    const MachineFacts& machine);

/// A port as it was tried. A value.
struct PortFacts {
  Listener listener;
  /// TryToBind's.
  int bind_error = 0;
};
/// Whether a server of `user` can listen there.
[[nodiscard]] Finding PortFinding(const PortFacts& port, const MachineFacts& machine,
                                  const std::string& user);

/// Descriptors that the configuration may need.
[[nodiscard]] std::size_t DescriptorsWanted(const config::Config& config);
/// `server`: the one that runs, if one does.
[[nodiscard]] Finding DescriptorsFinding(const config::Config& config,
                                         const std::optional<ServerProcess>& server,
                                         const MachineFacts& machine);

/// Whether the kernel says that its clock is kept synchronised.
[[nodiscard]] Finding ClockFinding(bool kernel_synchronised);

}  // namespace uplink::ctl
