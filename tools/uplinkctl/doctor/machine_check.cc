#include "tools/uplinkctl/doctor/machine_check.h"

#include <algorithm>
#include <cerrno>
#include <string>
#include <system_error>
#include <utility>

#include <fmt/core.h>

#include "schema/base/doc_page.h"
#include "server/transport/descriptors.h"
#include "tools/uplinkctl/doctor/socket_check.h"

namespace uplink::ctl {
namespace {

constexpr const char* kRelayKey = "listen.relay";
constexpr const char* kProgram = "uplinkd";

/// The socket that keeps a server from that address. One on the address itself comes first: a
/// socket on [::] may be for IPv6 alone, and then another one has 0.0.0.0.
const ListeningSocket* SocketAt(const config::ListenAddress& address, const MachineFacts& machine) {
  const ListeningSocket* collides = nullptr;
  for (const ListeningSocket& each : machine.sockets) {
    if (each.port == address.port && each.host == address.host) return &each;
    if (collides == nullptr && config::Collide({each.host, each.port}, address)) collides = &each;
  }
  return collides;
}

/// Who has the address; "another program" where this user may not see that.
std::string HolderText(const config::ListenAddress& address, const MachineFacts& machine) {
  const ListeningSocket* socket = SocketAt(address, machine);
  if (socket == nullptr) return "another program";
  const auto holder = machine.holders.find(socket->inode);
  if (holder == machine.holders.end()) {
    return fmt::format("a program of user id {} (root sees which)", socket->owner);
  }
  const Process& process = holder->second;
  // A server of the user whom we look for would have been taken for one.
  if (process.name == kProgram) {
    return fmt::format("a program named {} of user id {} (pid {})", kProgram, process.owner,
                       process.pid);
  }
  return fmt::format("{} (pid {})", process.name, process.pid);
}

Finding TakenFinding(const Listener& listener, const MachineFacts& machine,
                     const std::optional<ServerProcess>& running) {
  const std::string address = config::ToText(listener.address);
  if (const auto server = ServerAt(listener.address, machine)) {
    if (running && running->pid == server->pid) {
      return Ok(listener.key,
                fmt::format("{} is held by the running uplinkd (pid {})", address, server->pid));
    }
    return Error(listener.key,
                 fmt::format("{} is held by an uplinkd of another configuration (pid {})", address,
                             server->pid),
                 fmt::format("stop that server, or set {} to another port", listener.key));
  }
  return Error(listener.key,
               fmt::format("{} is held by {}", address, HolderText(listener.address, machine)),
               fmt::format("stop that program, or set {} to another port", listener.key));
}

/// Whether every socket of the process that can be seen is one of these ports.
bool ListensOnlyAt(const std::vector<PortFacts>& ports, pid_t pid, const MachineFacts& machine) {
  return std::all_of(machine.sockets.begin(), machine.sockets.end(),
                     [&](const ListeningSocket& socket) {
                       const auto holder = machine.holders.find(socket.inode);
                       return holder == machine.holders.end() || holder->second.pid != pid ||
                              std::any_of(ports.begin(), ports.end(), [&](const PortFacts& port) {
                                return port.listener.address.port == socket.port;
                              });
                     });
}

std::optional<ServerProcess> ServerWithPid(pid_t pid, const MachineFacts& machine) {
  const auto found = std::ranges::find(machine.servers, pid, &ServerProcess::pid);
  return found == machine.servers.end() ? std::nullopt : std::optional(*found);
}

/// The uplinkd that has a port or a Unix socket.
std::optional<ServerProcess> HolderOf(const PortFacts& port, const MachineFacts& machine) {
  if (config::IsUnix(port.listener.address)) return ServerWithPid(port.holder, machine);
  return ServerAt(port.listener.address, machine);
}

/// Whether it may be any that is free.
bool IsAny(const PortFacts& port) {
  return port.listener.address.port == 0 && !config::IsUnix(port.listener.address);
}

}  // namespace

bool HasUnknownHolder(const std::vector<PortFacts>& ports, const MachineFacts& machine) {
  return std::any_of(ports.begin(), ports.end(), [&](const PortFacts& port) {
    if (port.bind_error != EADDRINUSE) return false;
    return config::IsUnix(port.listener.address)
               ? !ServerWithPid(port.holder, machine)
               : SocketAt(port.listener.address, machine) == nullptr;
  });
}

bool FixesPort(const std::vector<PortFacts>& ports) {
  return std::any_of(ports.begin(), ports.end(),
                     [](const PortFacts& port) { return !IsAny(port); });
}

std::optional<ServerProcess> OwnServer(const std::vector<PortFacts>& ports,
                                       const MachineFacts& machine) {
  std::optional<ServerProcess> own;
  bool relay_free = false;
  for (const PortFacts& port : ports) {
    if (IsAny(port)) continue;
    if (port.listener.key == kRelayKey && port.bind_error == 0) {
      relay_free = true;
      continue;
    }
    std::optional<ServerProcess> server;
    if (port.bind_error == EADDRINUSE) server = HolderOf(port, machine);
    if (!server || (own && own->pid != server->pid)) return std::nullopt;
    own = std::move(server);
  }
  if (own && relay_free && !ListensOnlyAt(ports, own->pid, machine)) return std::nullopt;
  return own;
}

MachineFacts WithServersOf(uid_t user, MachineFacts machine) {
  std::erase_if(machine.servers,
                [user](const ServerProcess& server) { return server.owner != user; });
  return machine;
}

std::optional<ServerProcess> ServerAt(const config::ListenAddress& address,
                                      const MachineFacts& machine) {
  const ListeningSocket* socket = SocketAt(address, machine);
  if (socket == nullptr) return std::nullopt;
  const auto holder = machine.holders.find(socket->inode);
  const auto found =
      std::find_if(machine.servers.begin(), machine.servers.end(), [&](const ServerProcess& each) {
        return holder == machine.holders.end() ? each.owner == socket->owner
                                               : each.pid == holder->second.pid;
      });
  if (found == machine.servers.end()) return std::nullopt;
  return *found;
}

Finding PortFinding(const PortFacts& port, const MachineFacts& machine, const PortUser& user) {
  if (config::IsUnix(port.listener.address)) return SocketFinding(port, user);
  const Listener& listener = port.listener;
  const std::string address = config::ToText(listener.address);
  switch (port.bind_error) {
    case 0:
      return Ok(listener.key, listener.address.port == 0 ? address + " takes any free port"
                                                         : address + " is free");
    case EADDRINUSE:
      return TakenFinding(listener, machine, user.running);
    case EACCES:
      return Error(listener.key, fmt::format("{} may not listen on {}", user.name, address),
                   "set a port from 1024 on");
    case EADDRNOTAVAIL:
      return Error(listener.key, fmt::format("no interface of this machine has {}", address),
                   "set one of the addresses that `ip address` shows, or [::] for all");
    case EAFNOSUPPORT:
      return Error(listener.key, fmt::format("this machine has no IPv6 for {}", address),
                   fmt::format("set {} = \"0.0.0.0:{}\"", listener.key, listener.address.port));
    default:
      return Error(listener.key,
                   fmt::format("{}: {}", address, std::generic_category().message(port.bind_error)),
                   "set another address");
  }
}

std::size_t DescriptorsWanted(const config::Config& config) {
  const std::size_t of_metrics =
      config::IsSet(config.listen.metrics) ? config::kMetricsConnectionsMax : 0;
  const std::size_t of_fleet = config::IsSet(config.listen.fleet) ? config::kFleetDescriptors : 0;
  transport::RelayOptions options;
  options.proxy_protocol_from = config.listen.proxy_protocol_from;
  options.descriptors_reserved =
      transport::DescriptorsReserved(config.http.connections_max + of_metrics) + of_fleet;
  options.streams_max = transport::kStreamsPerRobot * config.limits.robots_max;
  return transport::DescriptorsWanted(options);
}

Finding DescriptorsFinding(const config::Config& config, const std::optional<ServerProcess>& server,
                           const MachineFacts& machine) {
  const std::size_t wanted = DescriptorsWanted(config);
  const std::optional<std::size_t> limit =
      server ? server->descriptors_max : machine.own_descriptors_max;
  const std::string whose = server
                                ? fmt::format("the running uplinkd (pid {}) may open", server->pid)
                                : "a server that is started from this shell may open";
  const std::string need =
      fmt::format("limits.robots_max = {} needs {}", config.limits.robots_max, wanted);
  if (!limit) {
    return Warning("descriptors",
                   fmt::format("how many files {} cannot be read, and {}", whose, need),
                   "run doctor as root");
  }
  if (*limit == kDescriptorsUnlimited) {
    return Ok("descriptors", fmt::format("{} any number of files", whose));
  }
  const std::string text = fmt::format("{} {} files, and {}", whose, *limit, need);
  if (*limit >= wanted) return Ok("descriptors", text);
  return Warning(
      "descriptors", text,
      "raise LimitNOFILE of the unit or `ulimit -n`; see " + DocPage("docs/operate/capacity.md"));
}

Finding ClockFinding(bool kernel_synchronised) {
  if (kernel_synchronised) return Ok("clock", "the kernel says that it is kept synchronised");
  return Warning("clock",
                 "the kernel does not say that it is kept synchronised: after a jump the server "
                 "deletes nothing until something vouches for the time",
                 "let NTP keep it (`uplinkctl store clock` shows what vouches for it)");
}

}  // namespace uplink::ctl
