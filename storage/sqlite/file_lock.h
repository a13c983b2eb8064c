#pragma once

#include <memory>
#include <string>

#include <absl/status/statusor.h>

namespace uplink::storage::sqlite {

/// Keeps a second writer away from a store: an exclusive lock on the file `<path>.lock`, which the
/// kernel drops when the process ends, however it ends. The file itself stays. A resource.
class FileLock final {
 public:
  /// Errors: kFailedPrecondition, naming the lock file, if it cannot be opened or if another
  ///         process holds it.
  [[nodiscard]] static absl::StatusOr<std::unique_ptr<FileLock>> Take(const std::string& path);

  FileLock(const FileLock&) = delete;
  FileLock& operator=(const FileLock&) = delete;
  ~FileLock();

 private:
  explicit FileLock(int descriptor) : descriptor_(descriptor) {}
  const int descriptor_;
};

}  // namespace uplink::storage::sqlite
