#include "storage/sqlite/file_lock.h"

#include <cerrno>
#include <system_error>

#include <absl/status/status.h>
#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

namespace uplink::storage::sqlite {

absl::StatusOr<std::unique_ptr<FileLock>> FileLock::Take(const std::string& path) {
  const std::string name = path + ".lock";
  const int descriptor = ::open(name.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  if (descriptor < 0) {
    return absl::FailedPreconditionError("cannot open " + name + ": " +
                                         std::generic_category().message(errno));
  }
  std::unique_ptr<FileLock> lock(new FileLock(descriptor));
  if (::flock(descriptor, LOCK_EX | LOCK_NB) == 0) return lock;
  const int cause = errno;
  if (cause == EWOULDBLOCK) {
    return absl::FailedPreconditionError("store " + path + " is in use by another process, which" +
                                         " holds " + name);
  }
  return absl::FailedPreconditionError("cannot lock " + name + ": " +
                                       std::generic_category().message(cause));
}

FileLock::~FileLock() { ::close(descriptor_); }

}  // namespace uplink::storage::sqlite
