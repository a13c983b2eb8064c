#pragma once

#include <cstddef>
#include <cstdint>
#include <ctime>
#include <optional>
#include <string>

#include <absl/status/status.h>
#include <absl/status/statusor.h>
#include <sys/types.h>

#include "server/log/logger.h"
#include "server/store/saved_access.h"
#include "storage/access_store.h"

namespace uplink::store {

/// The file of the saved copy, in one life of the server.
///
/// Errors: of files: logged when they change, and tried again by the next Save.
/// Thread: confined to one thread at a time; blocks on the file.
class AccessCopyFile final {
 public:
  /// An empty path: no copy is kept. `store`: what the log calls the store. The logger outlives it.
  AccessCopyFile(std::string path, std::string store, const log::Logger& logger);
  AccessCopyFile(const AccessCopyFile&) = delete;
  AccessCopyFile& operator=(const AccessCopyFile&) = delete;

  [[nodiscard]] const std::string& path() const { return path_; }
  /// Errors: those of ReadSavedAccess and ParseAccess.
  [[nodiscard]] absl::StatusOr<AccessCopy> Read() const;
  /// The store, which has this version now, went back behind the copy and lacks so many of its
  /// decisions: the copy stays beside the file, under the name with `.old`, when that is replaced.
  void KeepOld(AccessCopy copy, storage::AccessVersion version, std::size_t lacks);
  /// Replaces the file. Returns whether that was done; it is not while an old copy cannot be kept.
  bool Save(const AccessCopy& copy);
  /// The file is the one that was saved last, or none was as yet.
  [[nodiscard]] bool IsAsSaved() const;

 private:
  /// By which another file, or another text, is told. A value.
  struct Mark {
    ino_t file = 0;
    off_t size = 0;
    mode_t mode = 0;
    std::time_t changed_s = 0;
    std::int64_t changed_ns = 0;

    friend bool operator==(const Mark&, const Mark&) = default;
  };
  struct Old {
    AccessCopy copy;
    storage::AccessVersion version = 0;
    std::size_t lacks = 0;
  };

  /// Nothing: there is no file.
  [[nodiscard]] std::optional<Mark> Look() const;
  [[nodiscard]] absl::Status WriteOld();

  const std::string path_;
  const std::string store_;
  const log::Logger& logger_;
  /// Still to be written.
  std::optional<Old> old_;
  std::optional<Mark> saved_;
  std::string save_error_;
};

}  // namespace uplink::store
