#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include "storage/kept_tables.h"
#include "storage/postgres/own_connection.h"
#include "storage/postgres/parts.h"

namespace uplink::storage::postgres {
namespace {

constexpr std::string_view kRead =
    "SELECT clock_timestamp(), (SELECT at FROM uplinkd.clock_mark WHERE id = 0)";
constexpr std::string_view kSet =
    "INSERT INTO uplinkd.clock_mark (id, at) VALUES (0, $1::timestamptz)"
    " ON CONFLICT (id) DO UPDATE SET at = excluded.at";

std::string SetIfEmptySql() {
  std::string sql = "INSERT INTO uplinkd.clock_mark (id, at) SELECT 0, $1::timestamptz WHERE true";
  for (const std::string_view table : kKeptTables) {
    sql.append(" AND NOT EXISTS (SELECT 1 FROM uplinkd.").append(table).append(")");
  }
  return sql + " ON CONFLICT (id) DO NOTHING";
}

class PostgresClockMarks final : public ClockMarks {
 public:
  explicit PostgresClockMarks(std::unique_ptr<OwnConnection> connection)
      : connection_(std::move(connection)) {}

  absl::StatusOr<ClockReading> Read() override {
    const auto row = connection_->Read(StoreCallOf(kRead), "read the mark of the clock");
    if (!row.ok()) return row.status();
    ClockReading reading;
    reading.database = row->Time(0, 0);
    if (!row->Null(0, 1)) reading.mark = row->Time(0, 1);
    return reading;
  }
  absl::Status Set(SystemTime mark) override { return Write(kSet, mark); }
  absl::Status SetIfEmpty(SystemTime mark) override { return Write(set_if_empty_, mark); }

 private:
  absl::Status Write(std::string_view sql, SystemTime mark) {
    return connection_->Write(StoreCallOf(sql, mark), "set the mark of the clock").status();
  }

  const std::unique_ptr<OwnConnection> connection_;
  const std::string set_if_empty_ = SetIfEmptySql();
};

}  // namespace

absl::StatusOr<std::unique_ptr<ClockMarks>> MakeClockMarks(const StoreOptions& options,
                                                           const Clock& clock) {
  return MakeOverOwn<PostgresClockMarks>(options, clock);
}

}  // namespace uplink::storage::postgres
