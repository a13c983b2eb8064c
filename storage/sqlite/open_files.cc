#include "storage/sqlite/open_files.h"

#include <absl/status/status.h>
#include <sqlite3.h>

namespace uplink::storage::sqlite {
namespace {

absl::StatusOr<sqlite3_file*> FileOf(const Database& database, int which) {
  sqlite3_file* file = nullptr;
  const int code = sqlite3_file_control(database.handle(), "main", which, &file);
  if (code != SQLITE_OK) return database.Error(code, "find an open file");
  if (file == nullptr || file->pMethods == nullptr) {
    return absl::UnavailableError("sqlite " + database.path() + ": a file is not open");
  }
  return file;
}

}  // namespace

absl::StatusOr<sqlite3_file*> OpenDatabaseFile(const Database& database) {
  return FileOf(database, SQLITE_FCNTL_FILE_POINTER);
}

absl::StatusOr<sqlite3_file*> OpenWalFile(const Database& database) {
  return FileOf(database, SQLITE_FCNTL_JOURNAL_POINTER);
}

absl::StatusOr<std::int64_t> SizeOf(const Database& database, sqlite3_file* file) {
  sqlite3_int64 bytes = 0;
  const int code = file->pMethods->xFileSize(file, &bytes);
  if (code != SQLITE_OK) return database.Error(code, "look at the size of a file");
  return bytes;
}

}  // namespace uplink::storage::sqlite
