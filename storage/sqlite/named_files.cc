#include "storage/sqlite/named_files.h"

#include <cerrno>
#include <filesystem>
#include <system_error>

#include <sys/stat.h>

#include "schema/base/doc_page.h"

namespace uplink::storage::sqlite {
namespace {

namespace fs = std::filesystem;

absl::Status IsNotOurs(const std::string& name, const std::string& why) {
  return absl::UnavailableError(
      "store " + name + ": the name no longer leads to the file that the server has open (" + why +
      "): nothing is acked until it does. Do nothing before you have read what saves the rows, "
      "which this process alone may have: see " +
      DocPage("docs/operate/sqlite.md", "The file was moved or removed"));
}

/// Whether this process has the file open. True without /proc, where it cannot be known.
bool IsOpen(const std::pair<dev_t, ino_t>& file) {
  std::error_code error;
  fs::directory_iterator entry("/proc/self/fd", error);
  if (error) return true;
  for (; entry != fs::directory_iterator(); entry.increment(error)) {
    struct stat open {};
    if (error) return true;
    if (::stat(entry->path().c_str(), &open) != 0) continue;
    if (std::pair(open.st_dev, open.st_ino) == file) return true;
  }
  return false;
}

}  // namespace

absl::StatusOr<NamedFiles::Identity> NamedFiles::Look(const std::string& name) {
  struct stat file {};
  if (::stat(name.c_str(), &file) == 0) return Identity(file.st_dev, file.st_ino);
  return IsNotOurs(name, std::generic_category().message(errno));
}

absl::StatusOr<std::unique_ptr<NamedFiles>> NamedFiles::Note(Database& database) {
  std::unique_ptr<NamedFiles> noted(new NamedFiles());
  const std::string file = database.FileName();
  for (const std::string& name : {database.path(), file, file + "-wal", file + "-shm"}) {
    const absl::StatusOr<Identity> identity = Look(name);
    if (!identity.ok()) return identity.status();
    if (!IsOpen(*identity)) return IsNotOurs(name, "another file has it");
    noted->files_.push_back({name, *identity});
  }
  // The descriptor of a FileLock may stand for the database's; SQLite itself knows of its own.
  if (noted->files_[0].file != noted->files_[1].file || database.HasMoved()) {
    return IsNotOurs(database.path(), "another file has it");
  }
  if (database.path() == file) noted->files_.erase(noted->files_.begin());
  return noted;
}

absl::Status NamedFiles::Check() const {
  for (const Named& named : files_) {
    const absl::StatusOr<Identity> now = Look(named.name);
    if (!now.ok()) return now.status();
    if (*now != named.file) return IsNotOurs(named.name, "another file has it");
  }
  return absl::OkStatus();
}

}  // namespace uplink::storage::sqlite
