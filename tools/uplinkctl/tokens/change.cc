#include "tools/uplinkctl/tokens/change.h"

#include <cerrno>
#include <filesystem>
#include <optional>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/stat.h>
#include <unistd.h>

#include "schema/base/write_all.h"
#include "server/config/file_modes.h"
#include "tools/pki/folder_lock.h"

namespace uplink::ctl {
namespace {

constexpr mode_t kAsideMode = 0600;
/// Of a new file, if the folder's group can have it.
constexpr mode_t kGroupMode = 0640;

absl::Status Failed(const std::string& path, const char* doing, int error) {
  const char* const remedy = error == EACCES || error == EPERM ? "; let this user do it" : "";
  return absl::FailedPreconditionError(fmt::format("{}: cannot be {}: {}{}", path, doing,
                                                   std::generic_category().message(error), remedy));
}

/// A descriptor that is closed with it.
class File final {
 public:
  explicit File(int fd) : fd_(fd) {}
  ~File() {
    if (fd_ >= 0) close(fd_);
  }
  File(const File&) = delete;
  File& operator=(const File&) = delete;
  [[nodiscard]] int fd() const { return fd_; }

 private:
  const int fd_;
};

/// Gives a file the owner and the mode of the one that it takes the place of.
absl::Status TakeOver(int fd, const std::string& path, const struct stat& old) {
  struct stat own {};
  const bool same = fstat(fd, &own) == 0 && own.st_uid == old.st_uid && own.st_gid == old.st_gid;
  if (!same && fchown(fd, old.st_uid, old.st_gid) != 0) {
    return absl::FailedPreconditionError(
        fmt::format("{}: belongs to user {} and group {}, and this user cannot leave it to them; "
                    "let its owner or root do it",
                    path, old.st_uid, old.st_gid));
  }
  if (fchmod(fd, old.st_mode & 07777U) != 0) return Failed(path, "changed", errno);
  return absl::OkStatus();
}

/// A new file: the folder's group may read it, if this user can give it to that group.
absl::Status Begin(int fd, const std::string& path, const std::string& folder) {
  struct stat info {};
  if (stat(folder.c_str(), &info) != 0) return Failed(folder, "looked at", errno);
  if (fchown(fd, static_cast<uid_t>(-1), info.st_gid) != 0) return absl::OkStatus();
  return fchmod(fd, kGroupMode) == 0 ? absl::OkStatus() : Failed(path, "made", errno);
}

absl::Status Write(const std::filesystem::path& path, const std::string& folder,
                   const std::optional<struct stat>& old, const std::string& text) {
  const std::string whole = path.string();
  const std::string aside =
      (std::filesystem::path(folder) / fmt::format(".{}.new", path.filename().string())).string();
  // A call that was killed as it wrote may have left one.
  unlink(aside.c_str());
  const File file(
      open(aside.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, kAsideMode));
  if (file.fd() < 0) return Failed(aside, "written", errno);
  absl::Status good = old ? TakeOver(file.fd(), whole, *old) : Begin(file.fd(), whole, folder);
  if (good.ok() && (WriteAll(file.fd(), text, {}) != Written::kAll || fsync(file.fd()) != 0 ||
                    rename(aside.c_str(), whole.c_str()) != 0)) {
    good = Failed(whole, "written", errno);
  }
  if (!good.ok()) {
    unlink(aside.c_str());
    return good;
  }
  // The rename, too, is to outlast a power failure. Without it the file is the old one, and whole.
  const File opened(open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (opened.fd() >= 0) static_cast<void>(fsync(opened.fd()));
  return absl::OkStatus();
}

}  // namespace

absl::Status ChangeTokens(const std::string& path, Missing missing, const TokensChange& change) {
  std::error_code error;
  // The file behind a link is what is replaced.
  std::filesystem::path real = std::filesystem::canonical(path, error);
  if (error) real = path;
  const std::string folder = real.has_parent_path() ? real.parent_path().string() : ".";
  const pki::FolderLock lock(folder);
  struct stat info {};
  std::optional<struct stat> old;
  if (stat(real.c_str(), &info) == 0) old = info;
  identity::ReadTokens read;
  if (old || missing == Missing::kIsAnError) {
    auto file = identity::ReadTokenFile(real.string());
    if (!file.ok()) return file.status();
    if (absl::Status good = config::CheckWriters(real.string()); !good.ok()) return good;
    read = *std::move(file);
  }
  const absl::StatusOr<std::string> text = change(read);
  if (!text.ok()) return text.status();
  // What the server would refuse never takes the place of what it reads.
  const auto table = identity::TokenTable::Parse(*text, real.string());
  if (!table.ok()) return absl::FailedPreconditionError(table.status().message());
  return Write(real, folder, old, *text);
}

}  // namespace uplink::ctl
