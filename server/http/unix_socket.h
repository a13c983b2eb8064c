#pragma once

#include <string>
#include <utility>

#include <absl/status/status.h>
#include <sys/types.h>

namespace uplink::http {

/// Removes the socket that a server which is over has left at this path, if there is one.
///
/// Errors: kFailedPrecondition, if a server listens there, or what stands there is no socket.
/// Thread: any; asks the file system and connects to the socket.
[[nodiscard]] absl::Status ClearSocketPath(const std::string& path);

/// The file of a socket that we have bound. It is removed at the end, unless another has taken its
/// place.
class SocketFile final {
 public:
  SocketFile() = default;
  ~SocketFile();
  SocketFile(const SocketFile&) = delete;
  SocketFile& operator=(const SocketFile&) = delete;

  /// After bind and before listen, so that no peer comes in before it has its mode.
  ///
  /// Errors: kUnavailable, if the mode cannot be set.
  [[nodiscard]] absl::Status Own(std::string path, mode_t mode);

 private:
  /// Empty: none.
  std::string path_;
  dev_t device_ = 0;
  ino_t inode_ = 0;
};

}  // namespace uplink::http
