#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <utility>

#include "storage/clock_marks.h"
#include "storage/sqlite/open_beside.h"
#include "storage/sqlite/statement.h"

namespace uplink::storage::sqlite {

/// The mark in an SQLite file. It is one short write beside the store's writer, and takes no lock
/// but SQLite's own, so that an operator may set it while a server runs.
///
/// Errors:  of Open, kFailedPrecondition, naming the path: no file, not ours, not this program's
///          schema version, or another name of it (FileLock::Join). Of the calls, as in ClockMarks.
/// Thread:  as in ClockMarks.
class SqliteClockMarks final : public ClockMarks {
 public:
  /// As OpenBeside.
  [[nodiscard]] static absl::StatusOr<std::unique_ptr<SqliteClockMarks>> Open(
      const std::string& path, DamagePtr damage = nullptr);
  SqliteClockMarks(const SqliteClockMarks&) = delete;
  SqliteClockMarks& operator=(const SqliteClockMarks&) = delete;

  [[nodiscard]] absl::StatusOr<ClockReading> Read() override;
  [[nodiscard]] absl::Status Set(SystemTime mark) override;
  [[nodiscard]] absl::Status SetIfEmpty(SystemTime mark) override;

 private:
  explicit SqliteClockMarks(Beside beside) : beside_(std::move(beside)) {}

  Beside beside_;
  std::unique_ptr<Statement> read_, set_, set_if_empty_;
};

}  // namespace uplink::storage::sqlite
