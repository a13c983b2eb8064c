#include "tools/uplinkctl/doctor/socket_check.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <system_error>

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

namespace uplink::ctl {
namespace {

std::string FolderOf(const std::string& path) {
  return std::filesystem::path(path).parent_path().string();
}

/// 0, or why a file cannot be made or replaced in the folder.
int TryFolder(const std::string& folder) {
  return ::faccessat(AT_FDCWD, folder.c_str(), W_OK | X_OK, AT_EACCESS) == 0 ? 0 : errno;
}

/// Who listens at the other end.
pid_t PeerOf(int socket) {
  ucred peer{};
  socklen_t size = sizeof peer;
  return ::getsockopt(socket, SOL_SOCKET, SO_PEERCRED, &peer, &size) == 0 ? peer.pid : 0;
}

/// Of a path that is a socket.
SocketTrial TryToConnect(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.size() >= sizeof address.sun_path) return {ENAMETOOLONG};
  std::memcpy(static_cast<char*>(address.sun_path), path.data(), path.size());
  const int socket = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (socket < 0) return {errno};
  const void* const place = &address;
  const int result = ::connect(socket, static_cast<const sockaddr*>(place), sizeof address);
  const int error = result == 0 ? 0 : errno;
  SocketTrial trial;
  if (error == ECONNREFUSED) {
    trial.error = TryFolder(FolderOf(path));
  } else if (error == 0 || error == EAGAIN) {
    // Its queue may be full: then nothing says who it is.
    trial = {EADDRINUSE, error == 0 ? PeerOf(socket) : 0};
  } else {
    trial.error = error;
  }
  ::close(socket);
  return trial;
}

}  // namespace

SocketTrial TryToListenAt(const std::string& path) {
  struct stat status {};
  if (::lstat(path.c_str(), &status) == 0) {
    return S_ISSOCK(status.st_mode) ? TryToConnect(path) : SocketTrial{EEXIST};
  }
  return {errno == ENOENT ? TryFolder(FolderOf(path)) : errno};
}

Finding SocketFinding(const PortFacts& socket, const PortUser& user) {
  const std::string& key = socket.listener.key;
  const std::string& path = socket.listener.address.path;
  const std::string folder = FolderOf(path);
  switch (socket.bind_error) {
    case 0:
      return Ok(key, path + " is free");
    case EADDRINUSE:
      if (user.running && user.running->pid == socket.holder) {
        return Ok(key, fmt::format("{} is held by the running uplinkd (pid {})", path,
                                   user.running->pid));
      }
      return Error(key,
                   socket.holder == 0
                       ? path + " is held by another program"
                       : fmt::format("{} is held by another program (pid {})", path, socket.holder),
                   fmt::format("stop that program, or set {} to another path", key));
    case ENOENT:
      return Warning(key, folder + " is not there",
                     "make it, so that " + user.name +
                         " may write into it; the unit makes /run/uplinkd when it starts");
    case EEXIST:
      return Error(key, path + " is no socket", fmt::format("set {} to another path", key));
    case EACCES:
      return Error(key, fmt::format("{} may not make a socket in {}", user.name, folder),
                   fmt::format("make {} its owner", user.name));
    default:
      return Error(key,
                   fmt::format("{}: {}", path, std::generic_category().message(socket.bind_error)),
                   "set another path");
  }
}

}  // namespace uplink::ctl
