#pragma once

#include <memory>
#include <string>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

namespace uplink::storage::sqlite {

/// Keeps a second writer away from a store, by whatever name it comes, until this object goes or
/// the process ends, however it ends. A resource.
///
/// Three locks; each catches what the others miss:
/// - the file `<path>.lock`, by the path as it was given: earlier versions know this one alone;
/// - `<real path>.lock`, if the path is a link to the file: a process that was given the real path
///   takes it too, and so does one that opens another file in the place of ours;
/// - a byte of the store's file itself, far behind its end: hard links and mounts of the same file.
///
/// The files of the first two stay. The descriptor of the third is closed here alone, after the
/// database: closing one drops the locks that SQLite has on the file for this process. What reads
/// in this process may be closed later; it writes nothing.
///
/// None of that helps where a file has several names by hard links: SQLite's WAL lies beside the
/// name by which the file was opened, and under another name its rows are missing, or a WAL of
/// other times is written over the file. Such a file is refused.
class FileLock final {
 public:
  /// Makes the store's file, for its owner alone, if it is not there.
  ///
  /// As root, a lock file that it makes goes to the owner of the store's file.
  ///
  /// Errors: kFailedPrecondition, naming the file, if one of them cannot be opened, if another
  ///         process holds it (IsInUse), or if the store's file has hard links.
  [[nodiscard]] static absl::StatusOr<std::unique_ptr<FileLock>> Take(const std::string& path);

  /// For a program that writes to a file beside its server, if there is one. Takes no lock and
  /// makes nothing, but ensures that a server which has the file has it by this name. Must be
  /// called before the database is opened, and go after it. Whether the file is there is not
  /// checked.
  ///
  /// Errors: kFailedPrecondition, naming the file, if the file has hard links, if another process
  ///         has it by another name or through another mount, or if that cannot be known.
  [[nodiscard]] static absl::StatusOr<std::unique_ptr<FileLock>> Join(const std::string& path);

  /// Whether a process holds the store by any of the three locks, this one included. Makes nothing
  /// and waits for nothing. For a process that has not opened the database: what it opens here and
  /// closes would drop SQLite's locks.
  ///
  /// Errors: kFailedPrecondition, naming the file, if a lock file cannot be opened.
  [[nodiscard]] static absl::StatusOr<bool> IsHeld(const std::string& path);

  FileLock(const FileLock&) = delete;
  FileLock& operator=(const FileLock&) = delete;
  ~FileLock();

 private:
  /// A descriptor that is closed with it.
  class Held;

  FileLock();
  std::unique_ptr<Held> name_;
  std::unique_ptr<Held> real_name_;
  std::unique_ptr<Held> file_;
};

/// The error of FileLock::Take is that another process holds the store, and no other.
[[nodiscard]] bool IsInUse(const absl::Status& status);

}  // namespace uplink::storage::sqlite
