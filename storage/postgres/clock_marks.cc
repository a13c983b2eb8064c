#include "storage/postgres/clock_marks.h"

#include <string>
#include <utility>

#include "storage/kept_tables.h"
#include "storage/postgres/own_connection.h"

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

}  // namespace

struct PostgresClockMarks::Impl {
  std::unique_ptr<OwnConnection> connection;
  const std::string set_if_empty = SetIfEmptySql();

  [[nodiscard]] absl::Status Write(std::string_view sql, SystemTime mark) const {
    StoreCall call{sql, {}};
    call.parameters.Time(mark);
    return connection->Write(std::move(call), "set the mark of the clock").status();
  }
};

PostgresClockMarks::PostgresClockMarks(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
PostgresClockMarks::~PostgresClockMarks() = default;

absl::StatusOr<std::unique_ptr<PostgresClockMarks>> PostgresClockMarks::Make(
    const StoreOptions& options, const Clock& clock) {
  absl::StatusOr<std::unique_ptr<OwnConnection>> connection = OwnConnection::Make(options, clock);
  if (!connection.ok()) return connection.status();
  return std::unique_ptr<PostgresClockMarks>(
      new PostgresClockMarks(std::make_unique<Impl>(Impl{*std::move(connection)})));
}

absl::StatusOr<ClockReading> PostgresClockMarks::Read() {
  std::vector<StoreCall> calls;
  calls.push_back({kRead, {}});
  const auto answer = impl_->connection->Read(calls, "read the mark of the clock");
  if (!answer.ok()) return answer.status();
  const Result& row = answer->front();
  ClockReading reading;
  reading.database = row.Time(0, 0);
  if (!row.Null(0, 1)) reading.mark = row.Time(0, 1);
  return reading;
}

absl::Status PostgresClockMarks::Set(SystemTime mark) { return impl_->Write(kSet, mark); }

absl::Status PostgresClockMarks::SetIfEmpty(SystemTime mark) {
  return impl_->Write(impl_->set_if_empty, mark);
}

}  // namespace uplink::storage::postgres
