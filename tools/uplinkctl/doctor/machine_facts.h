#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <sys/types.h>

#include "server/config/address.h"

namespace uplink::ctl {

/// A TCP socket that listens, as /proc/net/tcp has it. A value.
struct ListeningSocket {
  std::string host;
  std::uint16_t port = 0;
  uid_t owner = 0;
  std::uint64_t inode = 0;
};

/// A process. A value.
struct Process {
  pid_t pid = 0;
  std::string name;
  uid_t owner = 0;
};

/// Stands for no limit of open files.
inline constexpr std::size_t kDescriptorsUnlimited = std::numeric_limits<std::size_t>::max();

/// A process whose program is uplinkd.
struct ServerProcess : Process {
  /// Its soft RLIMIT_NOFILE, or kDescriptorsUnlimited; nothing: it cannot be read.
  std::optional<std::size_t> descriptors_max;
};

/// What /proc says of the machine; facts that this user may not see are absent. A value.
struct MachineFacts {
  std::vector<ListeningSocket> sockets;
  /// By the inode of a listening socket. Only root sees the sockets of others.
  std::map<std::uint64_t, Process> holders;
  std::vector<ServerProcess> servers;
  /// The hard RLIMIT_NOFILE of this process, or kDescriptorsUnlimited; nothing: it cannot be read.
  /// uplinkd raises its own soft one to it.
  std::optional<std::size_t> own_descriptors_max;
};

/// Processes that are looked at.
inline constexpr std::size_t kProcessesMax = 100'000;

/// Any thread; reads /proc.
[[nodiscard]] MachineFacts ReadMachine();

/// ReadMachine once more. What `before` knew of sockets that are still there stays known: it may
/// have been read as root.
[[nodiscard]] MachineFacts ReadMachineAgain(const MachineFacts& before);

/// The listening sockets of /proc/net/tcp or /proc/net/tcp6. A pure function; lines that it cannot
/// read count for nothing.
[[nodiscard]] std::vector<ListeningSocket> ParseSockets(std::string_view table);

/// The soft limit of open files in /proc/PID/limits, or kDescriptorsUnlimited. A pure function;
/// nothing if the text has none.
[[nodiscard]] std::optional<std::size_t> ParseDescriptorsMax(std::string_view limits);

/// What the system says to a server that would listen there: 0, or an errno value. Accepts nothing.
[[nodiscard]] int TryToBind(const config::ListenAddress& address);

}  // namespace uplink::ctl
