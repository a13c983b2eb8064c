#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <sys/types.h>

#include "server/config/config.h"
#include "tools/uplinkctl/doctor/finding.h"
#include "tools/uplinkctl/doctor/machine_facts.h"
#include "tools/uplinkctl/listeners.h"

namespace uplink::ctl {

/// The machine without the servers of other users: every user may call a program uplinkd. A pure
/// function.
[[nodiscard]] MachineFacts WithServersOf(uid_t user, MachineFacts machine);

/// The uplinkd that listens there, if one does: by its sockets, or, where these cannot be seen, by
/// the user who owns the socket. All here are pure functions.
[[nodiscard]] std::optional<ServerProcess> ServerAt(const config::ListenAddress& address,
                                                    const MachineFacts& machine);

/// How a Unix socket was tried. A value.
struct SocketTrial {
  /// 0, or an errno value; EADDRINUSE: a program listens there.
  int error = 0;
  /// That program; 0: it is not known, or there is none.
  pid_t holder = 0;
};

/// A port or a Unix socket as it was tried. A value.
struct PortFacts {
  Listener listener;
  /// TryToBind's, or SocketTrial's.
  int bind_error = 0;
  /// SocketTrial's; of a port 0.
  pid_t holder = 0;
};
/// A port is in use, and `machine` knows no socket there: the program came after it was read.
[[nodiscard]] bool HasUnknownHolder(const std::vector<PortFacts>& ports,
                                    const MachineFacts& machine);
/// The running server of this configuration: one uplinkd that has every port that the configuration
/// fixes. While a server starts or stops, listen.relay may be free, if the server listens at no
/// other port.
[[nodiscard]] std::optional<ServerProcess> OwnServer(const std::vector<PortFacts>& ports,
                                                     const MachineFacts& machine);
/// A port does not stand for any free one, or is a Unix socket.
[[nodiscard]] bool FixesPort(const std::vector<PortFacts>& ports);

/// For whom a port is judged. A value.
struct PortUser {
  /// The server's user.
  std::string name;
  /// OwnServer's.
  std::optional<ServerProcess> running;
};
/// Whether the server can listen there, or does; of a Unix socket as SocketFinding.
[[nodiscard]] Finding PortFinding(const PortFacts& port, const MachineFacts& machine,
                                  const PortUser& user);

/// Descriptors that the configuration may need, as the server computes them for its warning
/// (transport::DescriptorsWanted, docs/operate/capacity.md).
[[nodiscard]] std::size_t DescriptorsWanted(const config::Config& config);
/// `server`: the one that runs, if one does.
[[nodiscard]] Finding DescriptorsFinding(const config::Config& config,
                                         const std::optional<ServerProcess>& server,
                                         const MachineFacts& machine);

/// Whether the kernel says that its clock is kept synchronised.
[[nodiscard]] Finding ClockFinding(bool kernel_synchronised);

}  // namespace uplink::ctl
