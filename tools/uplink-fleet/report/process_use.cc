#include "tools/uplink-fleet/report/process_use.h"

#include <charconv>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <string>
#include <system_error>

#include <fmt/core.h>
#include <unistd.h>

namespace uplink::synthetic {
namespace {

namespace fs = std::filesystem;

constexpr const char* kListening = "0A";
constexpr int kHex = 16;

/// Inodes of the sockets that listen on the port, by the kernel's table.
void AddListeners(const char* table, std::uint16_t port, std::set<std::string>& sockets) {
  std::ifstream file(table);
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) {
    // sl local_address rem_address st tx:rx tr:when retrnsmt uid timeout inode
    std::istringstream fields(line);
    std::string number, local, remote, state, queues, timer, retransmits, uid, timeout, inode;
    fields >> number >> local >> remote >> state >> queues >> timer >> retransmits >> uid >>
        timeout >> inode;
    const std::string hex = local.substr(local.find(':') + 1);
    unsigned found = 0;
    std::from_chars(hex.data(), hex.data() + hex.size(), found, kHex);
    if (state == kListening && found == port) sockets.insert("socket:[" + inode + "]");
  }
}

bool Holds(const fs::path& process, const std::set<std::string>& sockets) {
  std::error_code error;
  // Not by range: a process that ends meanwhile is no exception.
  for (fs::directory_iterator each(process / "fd", error), end; !error && each != end;
       each.increment(error)) {
    std::error_code gone;
    const fs::path target = fs::read_symlink(each->path(), gone);
    if (!gone && sockets.contains(target.string())) return true;
  }
  return false;
}

}  // namespace

std::optional<ProcessUse> UseOf(pid_t pid) {
  std::ifstream stat(fmt::format("/proc/{}/stat", pid));
  std::string text;
  if (!std::getline(stat, text)) return std::nullopt;
  // Behind the name, which ends with the last parenthesis: utime and stime are the 12th and 13th.
  std::istringstream fields(text.substr(text.rfind(')') + 2));
  std::string skipped;
  constexpr int kBeforeUtime = 11;
  for (int i = 0; i < kBeforeUtime; ++i) fields >> skipped;
  double user = 0;
  double system = 0;
  fields >> user >> system;
  std::ifstream statm(fmt::format("/proc/{}/statm", pid));
  std::uint64_t pages = 0;
  std::uint64_t resident = 0;
  statm >> pages >> resident;
  return ProcessUse{(user + system) / static_cast<double>(sysconf(_SC_CLK_TCK)),
                    resident * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE))};
}

std::optional<pid_t> ListenerOf(std::uint16_t port) {
  std::set<std::string> sockets;
  AddListeners("/proc/net/tcp", port, sockets);
  AddListeners("/proc/net/tcp6", port, sockets);
  if (sockets.empty()) return std::nullopt;
  std::error_code error;
  for (fs::directory_iterator each("/proc", error), last; !error && each != last;
       each.increment(error)) {
    const std::string name = each->path().filename().string();
    pid_t pid = 0;
    const auto [end, bad] = std::from_chars(name.data(), name.data() + name.size(), pid);
    if (bad == std::errc() && end == name.data() + name.size() && Holds(each->path(), sockets)) {
      return pid;
    }
  }
  return std::nullopt;
}

}  // namespace uplink::synthetic
