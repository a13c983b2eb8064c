#include <memory>
#include <string>
#include <utility>

#include "storage/kept_tables.h"
#include "storage/sqlite/connections.h"
#include "storage/sqlite/parts.h"

namespace uplink::storage::sqlite {
namespace {

std::string SetIfEmptySql() {
  std::string sql = "INSERT INTO clock_mark (id, at) SELECT 0, ?1 WHERE true";
  for (const std::string_view table : kKeptTables) {
    sql.append(" AND NOT EXISTS (SELECT 1 FROM ").append(table).append(")");
  }
  return sql + " ON CONFLICT (id) DO NOTHING";
}

class SqliteClockMarks final : public ClockMarks {
 public:
  explicit SqliteClockMarks(SideConnection side) : side_(std::move(side)) {}

  [[nodiscard]] absl::Status Prepare() {
    Preparer prepare(*side_.database);
    prepare.Into(read_, "SELECT at FROM clock_mark WHERE id = 0");
    prepare.Into(set_,
                 "INSERT INTO clock_mark (id, at) VALUES (0, ?)"
                 " ON CONFLICT (id) DO UPDATE SET at = excluded.at");
    prepare.Into(set_if_empty_, SetIfEmptySql());
    return prepare.status();
  }

  absl::StatusOr<ClockReading> Read() override {
    const auto mark = read_->Select().First([](const Rows& row) { return row.Time(0); });
    if (!mark.ok()) return mark.status();
    return ClockReading{.mark = *mark, .database = std::nullopt};
  }
  absl::Status Set(SystemTime mark) override { return set_->Run(mark); }
  absl::Status SetIfEmpty(SystemTime mark) override { return set_if_empty_->Run(mark); }

 private:
  SideConnection side_;
  std::unique_ptr<Statement> read_, set_, set_if_empty_;
};

}  // namespace

absl::StatusOr<std::unique_ptr<ClockMarks>> OpenClockMarks(const std::string& path,
                                                           DamagePtr damage) {
  return MakeOnSideConnection<SqliteClockMarks>(path, std::move(damage));
}

}  // namespace uplink::storage::sqlite
