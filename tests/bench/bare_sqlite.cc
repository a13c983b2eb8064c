#include "tests/bench/bare_sqlite.h"

#include <sqlite3.h>

#include "schema/base/check.h"

namespace uplink::bench {
namespace {

constexpr std::int64_t kNowMs = 1'763'726'400'000;

}  // namespace

BareSqlite::BareSqlite(const std::string& path, const LoadShape& shape)
    : shape_(shape), text_(shape.text_bytes, 'm') {
  UPLINK_CHECK(sqlite3_open(path.c_str(), &database_) == SQLITE_OK, "a new file opens");
  const char* const schema =
      "PRAGMA journal_mode = WAL; PRAGMA synchronous = FULL; PRAGMA cache_size = -16384;"
      "CREATE TABLE sessions (ruri TEXT NOT NULL, session BLOB NOT NULL, cursor INTEGER NOT NULL,"
      " last_used_ms INTEGER NOT NULL, PRIMARY KEY (ruri, session)) STRICT, WITHOUT ROWID;"
      "CREATE TABLE messages (ruri TEXT NOT NULL, received_ms INTEGER NOT NULL,"
      " entry INTEGER NOT NULL, fleet TEXT NOT NULL, session BLOB NOT NULL, seq INTEGER NOT NULL,"
      " sampled_ms INTEGER NOT NULL, level INTEGER NOT NULL, message TEXT NOT NULL,"
      " PRIMARY KEY (ruri, received_ms, entry)) STRICT;"
      "CREATE INDEX messages_by_fleet ON messages (fleet, received_ms, entry);"
      "CREATE INDEX messages_by_time ON messages (received_ms, entry);";
  UPLINK_CHECK(sqlite3_exec(database_, schema, nullptr, nullptr, nullptr) == SQLITE_OK,
               sqlite3_errmsg(database_));
  insert_ = Prepare("INSERT INTO messages VALUES (?, ?, ?, 'bench', x'01', ?, ?, 0, ?)");
  raise_ = Prepare(
      "INSERT INTO sessions VALUES (?, x'01', ?, ?) ON CONFLICT (ruri, session) DO UPDATE"
      " SET cursor = max(cursor, excluded.cursor)");
  begin_ = Prepare("BEGIN IMMEDIATE");
  commit_ = Prepare("COMMIT");
}

BareSqlite::~BareSqlite() {
  for (sqlite3_stmt* statement : {insert_, raise_, begin_, commit_}) sqlite3_finalize(statement);
  sqlite3_close(database_);
}

sqlite3_stmt* BareSqlite::Prepare(const char* sql) {
  sqlite3_stmt* statement = nullptr;
  UPLINK_CHECK(sqlite3_prepare_v2(database_, sql, -1, &statement, nullptr) == SQLITE_OK,
               sqlite3_errmsg(database_));
  return statement;
}

void BareSqlite::Step(sqlite3_stmt* statement) {
  UPLINK_CHECK(sqlite3_step(statement) == SQLITE_DONE, sqlite3_errmsg(database_));
  sqlite3_reset(statement);
}

std::size_t BareSqlite::CommitOne() {
  Step(begin_);
  const auto per_robot = static_cast<std::int64_t>(shape_.per_robot);
  for (std::size_t i = 0; i < shape_.batch_records; ++i) {
    const std::string ruri = "rcan://bench.rcan/uplink/synthetic/1.0/writer-0-robot-" +
                             std::to_string(i / shape_.per_robot);
    const auto size = static_cast<int>(ruri.size());
    sqlite3_bind_text(insert_, 1, ruri.data(), size, SQLITE_STATIC);
    sqlite3_bind_int64(insert_, 2, kNowMs);
    sqlite3_bind_int64(insert_, 3, ++entry_);
    sqlite3_bind_int64(insert_, 4, base_ + static_cast<std::int64_t>(i % shape_.per_robot) + 1);
    sqlite3_bind_int64(insert_, 5, kNowMs);
    sqlite3_bind_text(insert_, 6, text_.data(), static_cast<int>(text_.size()), SQLITE_STATIC);
    Step(insert_);
    if (i % shape_.per_robot != 0) continue;
    sqlite3_bind_text(raise_, 1, ruri.data(), size, SQLITE_STATIC);
    sqlite3_bind_int64(raise_, 2, base_ + per_robot);
    sqlite3_bind_int64(raise_, 3, kNowMs);
    Step(raise_);
  }
  Step(commit_);
  base_ += per_robot;
  return shape_.batch_records;
}

}  // namespace uplink::bench
