#pragma once

#include <memory>
#include <string>

#include "tests/bench/store_load.h"

struct sqlite3;
struct sqlite3_stmt;

namespace uplink::bench {

/// The comparator: a loop on SQLite alone with the store's tables, a transaction a batch, durable
/// alike (WAL, FULL). Confined to one thread.
class BareSqlite final {
 public:
  /// Makes the file; aborts with SQLite's words.
  BareSqlite(const std::string& path, const LoadShape& shape);
  ~BareSqlite();
  BareSqlite(const BareSqlite&) = delete;
  BareSqlite& operator=(const BareSqlite&) = delete;

  /// Commits the next batch; returns its rows.
  std::size_t CommitOne();

 private:
  sqlite3_stmt* Prepare(const char* sql);
  void Step(sqlite3_stmt* statement);

  sqlite3* database_ = nullptr;
  sqlite3_stmt* insert_ = nullptr;
  sqlite3_stmt* raise_ = nullptr;
  sqlite3_stmt* begin_ = nullptr;
  sqlite3_stmt* commit_ = nullptr;
  const LoadShape shape_;
  std::string text_;
  std::int64_t base_ = 0;
  std::int64_t entry_ = 0;
};

}  // namespace uplink::bench
