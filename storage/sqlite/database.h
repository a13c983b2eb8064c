#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "schema/base/clock.h"
#include "storage/sqlite/damage.h"
#include "storage/sqlite/statement.h"

struct sqlite3;

namespace uplink::storage::sqlite {

/// What a connection may do.
enum class Access : std::uint8_t {
  /// Creates the file, readable by its owner alone, if it is not there.
  kWrite,
  kRead,
};

/// One connection to an SQLite file, with nothing set but what any file bears: see Configure in
/// schema.h for the rest.
///
/// Errors:  those of errors.h; kFailedPrecondition where the file or its folder cannot be opened.
///          Every message names the path.
/// Thread:  confined to one thread at a time.
class Database final {
 public:
  [[nodiscard]] static absl::StatusOr<std::unique_ptr<Database>> Open(const std::string& path,
                                                                      Access access,
                                                                      milliseconds busy_timeout);

  ~Database();
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;

  /// From now on damage that SQLite finds is noted there; and once some is noted, this connection
  /// moves no WAL into the file as it closes. Nor does it once it found some itself.
  void ReportDamageTo(DamagePtr damage) { damage_ = std::move(damage); }
  [[nodiscard]] const DamagePtr& damage() const { return damage_; }

  /// Runs statements without parameters, one after the other.
  [[nodiscard]] absl::Status Execute(const std::string& sql);
  /// The first column of the first row.
  [[nodiscard]] absl::StatusOr<std::int64_t> ReadInt(const std::string& sql);
  [[nodiscard]] absl::StatusOr<std::string> ReadText(const std::string& sql);
  [[nodiscard]] absl::StatusOr<std::unique_ptr<Statement>> Prepare(std::string_view sql);

  /// Runs `work` in a transaction of its own; all or nothing.
  template <typename Work>
  [[nodiscard]] auto InTransaction(const Work& work) -> std::invoke_result_t<Work> {
    absl::Status status = Execute("BEGIN IMMEDIATE");
    if (!status.ok()) return status;
    auto result = work();
    status = result.status();
    if (status.ok()) status = Execute("COMMIT");
    if (status.ok()) return result;
    RollbackIfOpen();
    return status;
  }
  /// Rolls back if a transaction is open: some failures of SQLite end it, others do not.
  void RollbackIfOpen();

  /// Moves as much of the WAL into the database as readers allow (a passive checkpoint). The rest
  /// is left to the next one, as SQLite does after a commit.
  void MoveWal();
  /// Moves all of the WAL into the database and cuts its file to nothing, if no other connection
  /// uses it; what can be moved is moved even so. Waits for none of them.
  void EmptyWal();

  /// From now on a statement may take `steps_max` steps of SQLite's machine; 0: any number.
  void LimitSteps(std::int64_t steps_max);

  /// The status of result code `code`; `sql` is what failed.
  [[nodiscard]] absl::Status Error(int code, std::string_view sql) const;
  [[nodiscard]] const std::string& path() const { return path_; }
  /// The same without links: what SQLite opened, and beside which the WAL lies.
  [[nodiscard]] std::string FileName() const;
  /// Whether that name leads to another inode than the open file's, or to none.
  [[nodiscard]] bool HasMoved() const;
  /// For what is no SQL.
  [[nodiscard]] sqlite3* handle() const { return handle_.get(); }

 private:
  struct Close {
    void operator()(sqlite3* handle) const;
  };
  Database(std::string path, milliseconds busy_timeout)
      : path_(std::move(path)), busy_timeout_(busy_timeout) {}
  void SetBusyTimeout(milliseconds timeout);
  /// `mode`: of sqlite3_wal_checkpoint_v2.
  void RunCheckpoint(int mode);
  template <typename Take>
  [[nodiscard]] absl::Status ReadFirst(const std::string& sql, const Take& take);
  static int OnProgress(void* database);

  const std::string path_;
  const milliseconds busy_timeout_;
  std::unique_ptr<sqlite3, Close> handle_;
  std::int64_t steps_left_ = 0;
  DamagePtr damage_;
};

/// Prepares many statements and remembers the first failure.
class Preparer final {
 public:
  explicit Preparer(Database& database) : database_(database) {}

  void Into(std::unique_ptr<Statement>& statement, std::string_view sql) {
    if (!status_.ok()) return;
    absl::StatusOr<std::unique_ptr<Statement>> prepared = database_.Prepare(sql);
    if (prepared.ok()) {
      statement = *std::move(prepared);
    } else {
      status_ = prepared.status();
    }
  }
  [[nodiscard]] const absl::Status& status() const { return status_; }

 private:
  Database& database_;
  absl::Status status_;
};

}  // namespace uplink::storage::sqlite
