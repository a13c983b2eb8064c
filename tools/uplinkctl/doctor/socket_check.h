#pragma once

#include <string>

#include "tools/uplinkctl/doctor/finding.h"
#include "tools/uplinkctl/doctor/machine_check.h"

namespace uplink::ctl {

/// What the system says to a server that would make a Unix socket at `path`: as PortFacts has it.
/// ENOENT: its folder is not there. EEXIST: the path is something else than a socket. A socket that
/// no program listens at counts for nothing: the server replaces it.
///
/// Thread: any; asks the file system, and connects to a program that listens there.
[[nodiscard]] SocketTrial TryToListenAt(const std::string& path);

/// Whether the server can listen at a Unix socket, or does. A pure function.
[[nodiscard]] Finding SocketFinding(const PortFacts& socket, const PortUser& user);

}  // namespace uplink::ctl
