#include "storage/sqlite/clock_marks.h"

#include <utility>

#include "storage/kept_tables.h"
#include "storage/sqlite/open_beside.h"
#include "storage/sqlite/prepare.h"

namespace uplink::storage::sqlite {
namespace {

std::string SetIfEmptySql() {
  std::string sql = "INSERT INTO clock_mark (id, at) SELECT 0, ?1 WHERE true";
  for (const std::string_view table : kKeptTables) {
    sql.append(" AND NOT EXISTS (SELECT 1 FROM ").append(table).append(")");
  }
  return sql + " ON CONFLICT (id) DO NOTHING";
}

}  // namespace

absl::StatusOr<std::unique_ptr<SqliteClockMarks>> SqliteClockMarks::Open(const std::string& path,
                                                                         DamagePtr damage) {
  auto beside = OpenBeside(path, std::move(damage));
  if (!beside.ok()) return beside.status();
  Preparer prepare(*beside->database);
  std::unique_ptr<SqliteClockMarks> marks(new SqliteClockMarks(*std::move(beside)));
  prepare.Into(marks->read_, "SELECT at FROM clock_mark WHERE id = 0");
  prepare.Into(marks->set_,
               "INSERT INTO clock_mark (id, at) VALUES (0, ?)"
               " ON CONFLICT (id) DO UPDATE SET at = excluded.at");
  prepare.Into(marks->set_if_empty_, SetIfEmptySql());
  if (!prepare.status().ok()) return prepare.status();
  return marks;
}

absl::StatusOr<ClockReading> SqliteClockMarks::Read() {
  Rows rows = read_->Select();
  const absl::StatusOr<bool> found = rows.Next();
  if (!found.ok()) return found.status();
  ClockReading reading;
  if (*found) reading.mark = FromUnixMs(rows.Int(0));
  return reading;
}

absl::Status SqliteClockMarks::Set(SystemTime mark) { return set_->Run(UnixMs(mark)); }

absl::Status SqliteClockMarks::SetIfEmpty(SystemTime mark) {
  return set_if_empty_->Run(UnixMs(mark));
}

}  // namespace uplink::storage::sqlite
