#include "storage/sqlite/file_lock.h"

#include <cerrno>
#include <cstdint>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <thread>

#include <absl/status/status.h>
#include <absl/strings/cord.h>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

namespace uplink::storage::sqlite {

class FileLock::Held final {
 public:
  explicit Held(int descriptor) : descriptor_(descriptor) {}
  ~Held() { ::close(descriptor_); }
  Held(const Held&) = delete;
  Held& operator=(const Held&) = delete;
  [[nodiscard]] int descriptor() const { return descriptor_; }

 private:
  const int descriptor_;
};

namespace {

namespace fs = std::filesystem;

/// Owner alone, as the store's file.
constexpr mode_t kMode = 0600;
/// Who joins shares the lock of a name for an instant, to see whether somebody has it: about a
/// microsecond, if it is not interrupted. So many tries take about a tenth of a second.
constexpr int kSharedTries = 100'000;
/// The byte of the store's file that is locked: behind what SQLite can fill (2^48 bytes), and what
/// it locks itself (about 2^30).
constexpr off_t kLockedByte = off_t{1} << 62;
/// The payload of such an error; it is empty.
constexpr std::string_view kInUse = "uplinkd/store_in_use";

absl::Status Failed(const char* doing, const std::string& name, int cause) {
  std::string text =
      std::string(doing) + " " + name + ": " + std::generic_category().message(cause);
  if (cause == EACCES) {
    text += "; run this as the user who owns the store, or let user id " +
            std::to_string(::geteuid()) + " write the store and its folder";
  }
  return absl::FailedPreconditionError(text);
}

absl::Status InUse(const std::string& path, const std::string& what) {
  absl::Status status = absl::FailedPreconditionError(
      "store " + path + " is in use by another process, which holds " + what +
      "; stop that one first, or name another file");
  status.SetPayload({kInUse.data(), kInUse.size()}, absl::Cord());
  return status;
}

absl::Status HasLinks(const std::string& path, nlink_t names) {
  return absl::FailedPreconditionError(
      "store " + path + " has " + std::to_string(names) +
      " names (hard links): SQLite keeps the newest rows beside the name by which the file was"
      " opened, and under another name they would be missing, or the file be destroyed. Keep the"
      " name that the server uses, and remove the others: find FOLDER -xdev -samefile " +
      path);
}

absl::Status HasOtherName(const std::string& path) {
  return absl::FailedPreconditionError(
      "store " + path +
      " is in use under another name or through another mount (it is locked, and its lock file is"
      " not): to write by this name would destroy it. Use the path of the server's store.url, where"
      " the server itself sees it");
}

/// As root: what was made for a file is its owner's, or a server that is not root could not open
/// it. Where that is not allowed it stays as it is.
void GiveToOwnerOf(const std::string& path, int made) {
  if (::geteuid() != 0) return;
  struct stat store {};
  if (::stat(path.c_str(), &store) != 0 || !S_ISREG(store.st_mode)) return;
  static_cast<void>(::fchown(made, store.st_uid, store.st_gid) == 0);
}

/// A descriptor of the lock file `name` for the store at `path`, or -1 with errno. What was there
/// keeps its owner: it may be a link to anything.
int OpenLockFile(const std::string& name, const std::string& path) {
  const int made = ::open(name.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, kMode);
  if (made >= 0) GiveToOwnerOf(path, made);
  if (made >= 0 || errno != EEXIST) return made;
  return ::open(name.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, kMode);
}

/// OK if the lock file is locked through the descriptor. Who holds it for good holds it alone; one
/// that others share is looked at by who joins.
absl::Status LockName(int descriptor, const std::string& name, const std::string& path) {
  for (int tries = 0; tries < kSharedTries; ++tries) {
    if (::flock(descriptor, LOCK_EX | LOCK_NB) == 0) return absl::OkStatus();
    if (errno != EWOULDBLOCK) return Failed("cannot lock", name, errno);
    if (::flock(descriptor, LOCK_SH | LOCK_NB) != 0) break;
    static_cast<void>(::flock(descriptor, LOCK_UN));
    std::this_thread::yield();
  }
  return InUse(path, name);
}

struct flock LockedByte() {
  struct flock lock {};
  lock.l_type = F_WRLCK;
  lock.l_whence = SEEK_SET;
  lock.l_start = kLockedByte;
  lock.l_len = 1;
  return lock;
}

/// By an open file description, not by a process: it lasts until the descriptor is closed, whatever
/// SQLite closes meanwhile.
absl::Status LockFile(int descriptor, const std::string& path) {
  struct flock lock = LockedByte();
  if (::fcntl(descriptor, F_OFD_SETLK, &lock) == 0) return absl::OkStatus();
  // A kernel that has no such locks leaves those of the names.
  if (errno == EINVAL) return absl::OkStatus();
  if (errno == EAGAIN || errno == EACCES) return InUse(path, "it under this or another name");
  return Failed("cannot lock", path, errno);
}

/// Whether somebody holds the file itself. A kernel that has no such locks knows of none.
bool FileIsLocked(int descriptor) {
  struct flock lock = LockedByte();
  return ::fcntl(descriptor, F_OFD_GETLK, &lock) == 0 && lock.l_type != F_UNLCK;
}

/// Whether somebody holds the lock file `name`, this process included.
absl::StatusOr<bool> NameIsLocked(const std::string& name) {
  const int descriptor = ::open(name.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  if (descriptor < 0 && errno == ENOENT) return false;
  if (descriptor < 0) return Failed("cannot open", name, errno);
  const bool locked = ::flock(descriptor, LOCK_SH | LOCK_NB) != 0 && errno == EWOULDBLOCK;
  ::close(descriptor);
  return locked;
}

/// OK also if there is no file.
absl::Status CheckLinks(const std::string& path) {
  struct stat file {};
  if (::stat(path.c_str(), &file) != 0 || !S_ISREG(file.st_mode)) return absl::OkStatus();
  return file.st_nlink > 1 ? HasLinks(path, file.st_nlink) : absl::OkStatus();
}

/// Also behind a link to what is not there. This process cannot have had a missing file open, so
/// closing the descriptor drops no lock of ours.
absl::Status MakeIfMissing(const std::string& path) {
  std::error_code ignored;
  if (fs::exists(path, ignored)) return absl::OkStatus();
  const int made = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, kMode);
  if (made < 0) return Failed("cannot open", path, errno);
  ::close(made);
  return absl::OkStatus();
}

/// The path of the file that `path` leads to if that is a link; else nothing: links among the
/// folders lead to the same lock file.
std::string RealPath(const std::string& path) {
  std::error_code error;
  const fs::path real = fs::canonical(path, error);
  if (error) return {};
  const fs::path given(path);
  const fs::path folder = fs::canonical(given.has_parent_path() ? given.parent_path() : ".", error);
  if (error || real == folder / given.filename()) return {};
  return real.string();
}

/// Whether somebody holds the file by the name that SQLite uses, too: the path or the real one.
absl::StatusOr<bool> ANameIsLocked(const std::string& path) {
  absl::StatusOr<bool> given = NameIsLocked(path + ".lock");
  if (!given.ok() || *given) return given;
  const std::string real = RealPath(path);
  return real.empty() ? given : NameIsLocked(real + ".lock");
}

}  // namespace

FileLock::FileLock() = default;
FileLock::~FileLock() = default;

absl::StatusOr<std::unique_ptr<FileLock>> FileLock::Take(const std::string& path) {
  std::unique_ptr<FileLock> lock(new FileLock());
  const auto hold = [](std::unique_ptr<Held>& held, const std::string& name, int descriptor) {
    if (descriptor < 0) return Failed("cannot open", name, errno);
    held = std::make_unique<Held>(descriptor);
    return absl::OkStatus();
  };
  const auto hold_name = [&](std::unique_ptr<Held>& held, const std::string& name) {
    absl::Status status = hold(held, name, OpenLockFile(name, path));
    return status.ok() ? LockName(held->descriptor(), name, path) : status;
  };
  absl::Status status = hold_name(lock->name_, path + ".lock");
  if (status.ok()) status = MakeIfMissing(path);
  const std::string real = status.ok() ? RealPath(path) : std::string();
  if (!real.empty()) status = hold_name(lock->real_name_, real + ".lock");
  // After the names: who is refused by one of them in this process must not open the file.
  if (status.ok()) status = hold(lock->file_, path, ::open(path.c_str(), O_RDWR | O_CLOEXEC));
  if (status.ok()) status = LockFile(lock->file_->descriptor(), path);
  if (status.ok()) status = CheckLinks(path);
  if (!status.ok()) return status;
  return lock;
}

bool IsInUse(const absl::Status& status) {
  return status.GetPayload({kInUse.data(), kInUse.size()}).has_value();
}

absl::StatusOr<std::unique_ptr<FileLock>> FileLock::Join(const std::string& path) {
  std::unique_ptr<FileLock> lock(new FileLock());
  if (absl::Status links = CheckLinks(path); !links.ok()) return links;
  absl::StatusOr<bool> by_name = ANameIsLocked(path);
  if (!by_name.ok()) return by_name.status();
  // This process itself may have it, and must not open it again.
  if (*by_name) return lock;
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  if (descriptor < 0 && errno == EACCES) return Failed("cannot open", path, errno);
  // Opening the database reports why.
  if (descriptor < 0) return lock;
  lock->file_ = std::make_unique<Held>(descriptor);
  if (!FileIsLocked(descriptor)) return lock;
  // A server that came meanwhile has the name since then: names are locked first.
  by_name = ANameIsLocked(path);
  if (!by_name.ok()) return by_name.status();
  if (!*by_name) return HasOtherName(path);
  return lock;
}

absl::StatusOr<bool> FileLock::IsHeld(const std::string& path) {
  absl::StatusOr<bool> by_name = ANameIsLocked(path);
  if (!by_name.ok() || *by_name) return by_name;
  struct stat file {};
  if (::stat(path.c_str(), &file) != 0 || !S_ISREG(file.st_mode)) return false;
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  // There is no file, or it may not be read: its name is not locked.
  if (descriptor < 0) return false;
  const Held closed(descriptor);
  return FileIsLocked(descriptor);
}

}  // namespace uplink::storage::sqlite
