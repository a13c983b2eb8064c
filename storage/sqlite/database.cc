#include "storage/sqlite/database.h"

#include <cerrno>
#include <cstddef>
#include <filesystem>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <sqlite3.h>
#include <unistd.h>

#include "storage/sqlite/errors.h"

namespace uplink::storage::sqlite {
namespace {

/// How often, in steps, a limited statement looks at its limit.
constexpr int kProgressSteps = 1000;

/// SQL in messages is cut here: the first words say which statement it was.
constexpr std::size_t kSqlShownBytes = 80;

absl::Status CannotOpen(const std::string& path) {
  const int error = errno;
  const char* const remedy =
      error == ENOENT   ? "; correct the path, or make its folder"
      : error == EISDIR ? "; name the file in it"
                        : "; this user must be able to read and write the file, and its folder";
  return absl::FailedPreconditionError("cannot open " + path + ": " +
                                       std::generic_category().message(error) + remedy);
}

/// Makes a new file, for its owner alone, and says why a file that is there cannot be used: SQLite
/// itself says "unable to open database file" whatever the cause.
///
/// It must never open a file that is there: closing any descriptor of a file drops every POSIX lock
/// that this process has on it, those of SQLite's other connections among them. Without its lock,
/// the next foreign connection that closes takes itself for the last one and unlinks the WAL into
/// which we go on committing. (FileLock opens it before SQLite does, and closes it after.)
absl::Status TryFile(const std::string& path, Access access) {
  if (access == Access::kWrite) {
    const int made = ::open(path.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
    if (made >= 0) {
      ::close(made);
      return absl::OkStatus();
    }
    if (errno != EEXIST) return CannotOpen(path);
  }
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) {
    errno = EISDIR;
    return CannotOpen(path);
  }
  const int mode = access == Access::kWrite ? R_OK | W_OK : R_OK;
  return ::access(path.c_str(), mode) == 0 ? absl::OkStatus() : CannotOpen(path);
}

}  // namespace

Database::~Database() {
  if (damage_ == nullptr || damage_->status().ok()) return;
  sqlite3_db_config(handle_.get(), SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, 1, nullptr);
}

void Database::Close::operator()(sqlite3* handle) const { sqlite3_close_v2(handle); }

absl::StatusOr<std::unique_ptr<Database>> Database::Open(const std::string& path, Access access,
                                                         milliseconds busy_timeout) {
  absl::Status file = TryFile(path, access);
  if (!file.ok()) return file;
  std::unique_ptr<Database> database(new Database(path, busy_timeout));
  const int flags = (access == Access::kWrite ? SQLITE_OPEN_READWRITE : SQLITE_OPEN_READONLY) |
                    SQLITE_OPEN_NOMUTEX | SQLITE_OPEN_EXRESCODE;
  sqlite3* handle = nullptr;
  const int code = sqlite3_open_v2(path.c_str(), &handle, flags, nullptr);
  database->handle_.reset(handle);
  if (code != SQLITE_OK) {
    return MakeStatus(code, path, "open", handle == nullptr ? "no memory" : sqlite3_errmsg(handle));
  }
  database->SetBusyTimeout(busy_timeout);
  // The file's schema cannot make the program run functions with effects, nor corrupt itself.
  sqlite3_db_config(handle, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
  sqlite3_db_config(handle, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
  return database;
}

absl::Status Database::Execute(const std::string& sql) {
  const int code = sqlite3_exec(handle_.get(), sql.c_str(), nullptr, nullptr, nullptr);
  return code == SQLITE_OK ? absl::OkStatus() : Error(code, sql);
}

absl::StatusOr<std::int64_t> Database::ReadInt(const std::string& sql) {
  std::int64_t number = 0;
  const absl::Status read = ReadFirst(sql, [&number](const Rows& rows) { number = rows.Int(0); });
  if (!read.ok()) return read;
  return number;
}

absl::StatusOr<std::string> Database::ReadText(const std::string& sql) {
  std::string text;
  const absl::Status read = ReadFirst(sql, [&text](const Rows& rows) { text = rows.Bytes(0); });
  if (!read.ok()) return read;
  return text;
}

template <typename Take>
absl::Status Database::ReadFirst(const std::string& sql, const Take& take) {
  absl::StatusOr<std::unique_ptr<Statement>> statement = Prepare(sql);
  if (!statement.ok()) return statement.status();
  Rows rows = (*statement)->Select();
  const absl::StatusOr<bool> found = rows.Next();
  if (!found.ok()) return found.status();
  if (!*found) return Error(SQLITE_INTERNAL, sql);
  take(rows);
  return absl::OkStatus();
}

absl::StatusOr<std::unique_ptr<Statement>> Database::Prepare(std::string_view sql) {
  sqlite3_stmt* statement = nullptr;
  const int code = sqlite3_prepare_v3(handle_.get(), sql.data(), static_cast<int>(sql.size()),
                                      SQLITE_PREPARE_PERSISTENT, &statement, nullptr);
  if (code != SQLITE_OK) return Error(code, sql);
  return std::make_unique<Statement>(*this, statement);
}

void Database::RollbackIfOpen() {
  if (sqlite3_get_autocommit(handle_.get()) != 0) return;
  // It cannot fail with a transaction open, except that SQLite just ended it by itself.
  static_cast<void>(sqlite3_exec(handle_.get(), "ROLLBACK", nullptr, nullptr, nullptr));
}

void Database::SetBusyTimeout(milliseconds timeout) {
  sqlite3_busy_timeout(handle_.get(), static_cast<int>(timeout.count()));
}

void Database::RunCheckpoint(int mode) {
  const int code = sqlite3_wal_checkpoint_v2(handle_.get(), "main", mode, nullptr, nullptr);
  // For the damage that it may name.
  if (code != SQLITE_OK) static_cast<void>(Error(code, "checkpoint"));
}

void Database::MoveWal() { RunCheckpoint(SQLITE_CHECKPOINT_PASSIVE); }

void Database::EmptyWal() {
  SetBusyTimeout(milliseconds(0));
  RunCheckpoint(SQLITE_CHECKPOINT_TRUNCATE);
  SetBusyTimeout(busy_timeout_);
}

std::string Database::FileName() const { return sqlite3_db_filename(handle_.get(), "main"); }

bool Database::HasMoved() const {
  int moved = 0;
  const int code = sqlite3_file_control(handle_.get(), "main", SQLITE_FCNTL_HAS_MOVED, &moved);
  return code != SQLITE_OK || moved != 0;
}

void Database::LimitSteps(std::int64_t steps_max) {
  steps_left_ = steps_max;
  const bool limited = steps_max > 0;
  sqlite3_progress_handler(handle_.get(), limited ? kProgressSteps : 0,
                           limited ? &Database::OnProgress : nullptr, this);
}

int Database::OnProgress(void* database) {
  auto* const self = static_cast<Database*>(database);
  self->steps_left_ -= kProgressSteps;
  return self->steps_left_ < 0 ? 1 : 0;
}

absl::Status Database::Error(int code, std::string_view sql) const {
  absl::Status status =
      MakeStatus(code, path_, sql.substr(0, kSqlShownBytes), sqlite3_errmsg(handle_.get()));
  if (!absl::IsDataLoss(status)) return status;
  sqlite3_db_config(handle_.get(), SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, 1, nullptr);
  std::string text(status.message());
  if (damage_ != nullptr) damage_->Note(text);
  return absl::DataLossError(text.append(IfDamaged()));
}

}  // namespace uplink::storage::sqlite
