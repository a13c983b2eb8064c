#include "server/store/access_copy_file.h"

#include <utility>

#include <sys/stat.h>

namespace uplink::store {

AccessCopyFile::AccessCopyFile(std::string path, std::string store, const log::Logger& logger)
    : path_(std::move(path)), store_(std::move(store)), logger_(logger) {}

absl::StatusOr<AccessCopy> AccessCopyFile::Read() const {
  const absl::StatusOr<std::string> text = ReadSavedAccess(path_);
  if (!text.ok()) return text.status();
  return ParseAccess(*text, store_);
}

void AccessCopyFile::KeepOld(AccessCopy copy, storage::AccessVersion version, std::size_t lacks) {
  // The first has what every later one lacks.
  if (!path_.empty() && !old_) old_ = Old{std::move(copy), version, lacks};
}

bool AccessCopyFile::Save(const AccessCopy& copy) {
  absl::Status saved = WriteOld();
  if (saved.ok()) saved = SaveAccess(path_, TextOf(copy, store_));
  if (saved.ok()) saved_ = Look();
  const std::string before = std::exchange(save_error_, std::string(saved.message()));
  if (!saved.ok() && before != save_error_) {
    logger_.Warn("access_not_saved", {{"why", save_error_}});
  }
  return saved.ok();
}

absl::Status AccessCopyFile::WriteOld() {
  if (!old_) return absl::OkStatus();
  const std::string kept = path_ + ".old";
  // From memory: whatever became of the file, this is what was decided.
  absl::Status written = SaveAccess(kept, TextOf(old_->copy, store_));
  if (!written.ok()) return written;
  logger_.Warn("access_saved_list_newer", {{"version", old_->version},
                                           {"saved_version", old_->copy.version},
                                           {"lacks", old_->lacks},
                                           {"saved_list", path_},
                                           {"kept", kept}});
  old_.reset();
  return written;
}

bool AccessCopyFile::IsAsSaved() const { return !saved_ || Look() == saved_; }

std::optional<AccessCopyFile::Mark> AccessCopyFile::Look() const {
  struct stat status {};
  if (::stat(path_.c_str(), &status) != 0) return std::nullopt;
  return Mark{.file = status.st_ino,
              .size = status.st_size,
              .mode = status.st_mode,
              .changed_s = status.st_mtim.tv_sec,
              .changed_ns = status.st_mtim.tv_nsec};
}

}  // namespace uplink::store
