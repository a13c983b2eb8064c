#include "tools/uplinkctl/doctor/machine_facts.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <system_error>
#include <utility>

#include <arpa/inet.h>
#include <fmt/core.h>
#include <netinet/in.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

namespace uplink::ctl {
namespace {

constexpr std::string_view kProgram = "uplinkd";
/// TCP_LISTEN, as the table writes it.
constexpr std::string_view kListens = "0A";
constexpr std::string_view kSocketPrefix = "socket:[";

std::string ReadWhole(const std::string& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

template <typename Number>
std::optional<Number> NumberOf(std::string_view text, int base = 10) {
  Number number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number, base);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

/// `0100007F:1D38`: words of 32 bits in the machine's order, then the port.
bool ParsePlace(std::string_view text, ListeningSocket& socket) {
  const std::size_t colon = text.find(':');
  if (colon != 8 && colon != 32) return false;
  std::array<std::uint32_t, 4> words{};
  for (std::size_t i = 0; i * 8 < colon; ++i) {
    const auto word = NumberOf<std::uint32_t>(text.substr(i * 8, 8), 16);
    if (!word) return false;
    words.at(i) = *word;
  }
  const auto port = NumberOf<std::uint16_t>(text.substr(colon + 1), 16);
  std::array<char, INET6_ADDRSTRLEN> host{};
  const int family = colon == 8 ? AF_INET : AF_INET6;
  if (!port || inet_ntop(family, words.data(), host.data(), host.size()) == nullptr) return false;
  socket.host = host.data();
  socket.port = *port;
  return true;
}

std::optional<ListeningSocket> ParseSocket(const std::string& line) {
  std::istringstream words(line);
  // sl, local, remote, state, queues, timer, retransmits, uid, timeout, inode
  std::vector<std::string> column{std::istream_iterator<std::string>(words), {}};
  if (column.size() < 10 || column[3] != kListens) return std::nullopt;
  ListeningSocket socket;
  const auto owner = NumberOf<uid_t>(column[7]);
  const auto inode = NumberOf<std::uint64_t>(column[9]);
  if (!owner || !inode || !ParsePlace(column[1], socket)) return std::nullopt;
  socket.owner = *owner;
  socket.inode = *inode;
  return socket;
}

/// Which of the listening sockets the process has.
void ReadHolder(const Process& process, const std::string& folder, MachineFacts& facts) {
  std::error_code error;
  for (std::filesystem::directory_iterator file(folder + "/fd", error), end; !error && file != end;
       file.increment(error)) {
    std::error_code ignored;
    const std::string target = std::filesystem::read_symlink(file->path(), ignored).string();
    if (!target.starts_with(kSocketPrefix) || !target.ends_with(']')) continue;
    const auto inode = NumberOf<std::uint64_t>(std::string_view(target).substr(
        kSocketPrefix.size(), target.size() - kSocketPrefix.size() - 1));
    const auto listens = [&](const ListeningSocket& each) { return each.inode == *inode; };
    if (inode && std::any_of(facts.sockets.begin(), facts.sockets.end(), listens)) {
      facts.holders.emplace(*inode, process);
    }
  }
}

void ReadProcesses(MachineFacts& facts) {
  std::error_code error;
  std::size_t left = kProcessesMax;
  for (std::filesystem::directory_iterator entry("/proc", error), end;
       !error && entry != end && left > 0; entry.increment(error), --left) {
    const auto pid = NumberOf<pid_t>(entry->path().filename().string());
    if (!pid) continue;
    const std::string folder = entry->path().string();
    struct stat status {};
    if (::stat(folder.c_str(), &status) != 0) continue;
    Process process{*pid, ReadWhole(folder + "/comm"), status.st_uid};
    while (!process.name.empty() && process.name.back() == '\n') process.name.pop_back();
    ReadHolder(process, folder, facts);
    if (process.name != kProgram) continue;
    ServerProcess server;
    static_cast<Process&>(server) = process;
    server.descriptors_max = ParseDescriptorsMax(ReadWhole(folder + "/limits"));
    facts.servers.push_back(std::move(server));
  }
}

/// Empty for what is no address.
struct SocketAddress {
  sockaddr_storage storage{};
  socklen_t size = 0;
};

SocketAddress AddressOf(const config::ListenAddress& address) {
  SocketAddress found;
  sockaddr_in v4{};
  sockaddr_in6 v6{};
  if (inet_pton(AF_INET, address.host.c_str(), &v4.sin_addr) == 1) {
    v4.sin_family = AF_INET;
    v4.sin_port = htons(address.port);
    found.size = sizeof v4;
    std::memcpy(&found.storage, &v4, sizeof v4);
  } else if (inet_pton(AF_INET6, address.host.c_str(), &v6.sin6_addr) == 1) {
    v6.sin6_family = AF_INET6;
    v6.sin6_port = htons(address.port);
    found.size = sizeof v6;
    std::memcpy(&found.storage, &v6, sizeof v6);
  }
  return found;
}

}  // namespace

std::vector<ListeningSocket> ParseSockets(std::string_view table) {
  std::vector<ListeningSocket> sockets;
  std::istringstream lines{std::string(table)};
  for (std::string line; std::getline(lines, line);) {
    if (auto socket = ParseSocket(line)) sockets.push_back(*std::move(socket));
  }
  return sockets;
}

std::optional<std::size_t> ParseDescriptorsMax(std::string_view limits) {
  constexpr std::string_view kName = "Max open files";
  const std::size_t at = limits.find(kName);
  if (at == std::string_view::npos) return std::nullopt;
  std::istringstream words{std::string(limits.substr(at + kName.size()))};
  std::string soft;
  words >> soft;
  if (soft == "unlimited") return kDescriptorsUnlimited;
  return NumberOf<std::size_t>(soft);
}

MachineFacts ReadMachine() {
  MachineFacts facts;
  for (const char* table : {"/proc/net/tcp", "/proc/net/tcp6"}) {
    for (ListeningSocket& each : ParseSockets(ReadWhole(table))) {
      facts.sockets.push_back(std::move(each));
    }
  }
  ReadProcesses(facts);
  rlimit limit{};
  if (::getrlimit(RLIMIT_NOFILE, &limit) == 0) {
    facts.own_descriptors_max = limit.rlim_max == RLIM_INFINITY
                                    ? kDescriptorsUnlimited
                                    : static_cast<std::size_t>(limit.rlim_max);
  }
  return facts;
}

MachineFacts ReadMachineAgain(const MachineFacts& before) {
  MachineFacts facts = ReadMachine();
  for (const ListeningSocket& socket : facts.sockets) {
    const auto known = before.holders.find(socket.inode);
    if (known != before.holders.end()) facts.holders.insert(*known);
  }
  return facts;
}

int TryToBind(const config::ListenAddress& address) {
  const SocketAddress place = AddressOf(address);
  if (place.size == 0) return EINVAL;
  const int family = place.storage.ss_family;
  const int socket = ::socket(family, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (socket < 0) return errno;
  // As the server's own listeners: the port is free although connections to it have just ended, and
  // [::] takes IPv4 too.
  const int on = 1;
  const int off = 0;
  static_cast<void>(::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on));
  if (family == AF_INET6) {
    static_cast<void>(::setsockopt(socket, IPPROTO_IPV6, IPV6_V6ONLY, &off, sizeof off));
  }
  const int result =
      ::bind(socket, reinterpret_cast<const sockaddr*>(&place.storage),
             place.size);  // NOLINT(cppcoreguidelines-pro-type-reinterpret-cast): bind takes it so
  const int error = result == 0 ? 0 : errno;
  ::close(socket);
  return error;
}

}  // namespace uplink::ctl
