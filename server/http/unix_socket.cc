#include "server/http/unix_socket.h"

#include <cerrno>
#include <cstring>
#include <system_error>

#include <fmt/core.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

namespace uplink::http {
namespace {

std::string ErrorText() { return std::generic_category().message(errno); }

/// Whether a server accepts connections at this path. One that has no room for more does.
bool IsLive(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.size() >= sizeof(address.sun_path)) return false;
  std::memcpy(address.sun_path, path.data(), path.size());
  const int end = ::socket(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (end < 0) return true;
  // The library's way to pass addresses of any family.
  const auto* const any = reinterpret_cast<const sockaddr*>(&address);
  const bool refused = ::connect(end, any, sizeof(address)) != 0 && errno == ECONNREFUSED;
  ::close(end);
  return !refused;
}

}  // namespace

absl::Status ClearSocketPath(const std::string& path) {
  struct stat status {};
  if (::lstat(path.c_str(), &status) != 0) return absl::OkStatus();  // bind says what is wrong
  if (!S_ISSOCK(status.st_mode)) {
    return absl::FailedPreconditionError(
        fmt::format("{} is there and is no socket; name another path", path));
  }
  if (IsLive(path)) {
    return absl::FailedPreconditionError(
        fmt::format("a server listens at {}; stop it, or name another path", path));
  }
  ::unlink(path.c_str());
  return absl::OkStatus();
}

absl::Status SocketFile::Own(std::string path, mode_t mode) {
  struct stat status {};
  if (::chmod(path.c_str(), mode) != 0 || ::lstat(path.c_str(), &status) != 0) {
    const std::string why = ErrorText();
    ::unlink(path.c_str());
    return absl::UnavailableError(fmt::format("{} cannot get its mode: {}", path, why));
  }
  path_ = std::move(path);
  device_ = status.st_dev;
  inode_ = status.st_ino;
  return absl::OkStatus();
}

SocketFile::~SocketFile() {
  struct stat status {};
  if (path_.empty() || ::lstat(path_.c_str(), &status) != 0) return;
  if (status.st_dev == device_ && status.st_ino == inode_) ::unlink(path_.c_str());
}

}  // namespace uplink::http
