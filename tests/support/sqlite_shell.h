#pragma once

#include <memory>
#include <string>

struct sqlite3;

namespace uplink::testing {

/// A connection to an SQLite file beside the store's, as an operator's shell is: to look at rows
/// and to damage things. Failures abort with SQLite's message, but those of TryRun.
class SqliteShell final {
 public:
  explicit SqliteShell(const std::string& path);

  void Run(const std::string& sql);
  /// False if SQLite refuses.
  [[nodiscard]] bool TryRun(const std::string& sql);
  /// All values of all rows, `|` between columns, a line end after each row.
  [[nodiscard]] std::string Read(const std::string& sql);

 private:
  struct Close {
    void operator()(sqlite3* handle) const;
  };
  std::unique_ptr<sqlite3, Close> handle_;
};

}  // namespace uplink::testing
