#include "tests/support/sqlite_shell.h"

#include <sqlite3.h>

#include "schema/base/check.h"

namespace uplink::testing {
namespace {

int AppendRow(void* text, int columns, char** values, char** /*names*/) {
  auto& lines = *static_cast<std::string*>(text);
  for (int i = 0; i < columns; ++i) {
    if (i > 0) lines += '|';
    lines += values[i] == nullptr ? "NULL" : values[i];
  }
  lines += '\n';
  return 0;
}

}  // namespace

void SqliteShell::Close::operator()(sqlite3* handle) const { sqlite3_close_v2(handle); }

SqliteShell::SqliteShell(const std::string& path) {
  sqlite3* handle = nullptr;
  const int code = sqlite3_open(path.c_str(), &handle);
  handle_.reset(handle);
  UPLINK_CHECK(code == SQLITE_OK, "cannot open " + path);
  sqlite3_busy_timeout(handle, 5000);
}

void SqliteShell::Run(const std::string& sql) {
  UPLINK_CHECK(TryRun(sql), sql + ": " + sqlite3_errmsg(handle_.get()));
}

bool SqliteShell::TryRun(const std::string& sql) {
  return sqlite3_exec(handle_.get(), sql.c_str(), nullptr, nullptr, nullptr) == SQLITE_OK;
}

std::string SqliteShell::Read(const std::string& sql) {
  std::string lines;
  const int code = sqlite3_exec(handle_.get(), sql.c_str(), &AppendRow, &lines, nullptr);
  UPLINK_CHECK(code == SQLITE_OK, sql + ": " + sqlite3_errmsg(handle_.get()));
  return lines;
}

}  // namespace uplink::testing
