#include "storage/postgres/clock_marks.h"

#include <string>
#include <utility>

#include "storage/kept_tables.h"
#include "storage/postgres/link/link.h"
#include "storage/postgres/link_options.h"
#include "storage/postgres/write/transaction.h"

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
  Link link;
  const std::string set_if_empty = SetIfEmptySql();

  absl::Status Write(std::string_view sql, SystemTime mark) {
    const absl::StatusOr<Connection*> connection = link.Get();
    if (!connection.ok()) return connection.status();
    std::vector<StoreCall> calls;
    calls.push_back({kBegin, {}});
    calls.push_back({sql, {}});
    calls.back().parameters.Time(mark);
    return RunAndCommit(**connection, std::move(calls), "set the mark of the clock", {});
  }
};

PostgresClockMarks::PostgresClockMarks(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
PostgresClockMarks::~PostgresClockMarks() = default;

absl::StatusOr<std::unique_ptr<PostgresClockMarks>> PostgresClockMarks::Make(
    const StoreOptions& options, const Clock& clock) {
  absl::StatusOr<Link::Options> link = LinkOptionsOf(options);
  if (!link.ok()) return link.status();
  return std::unique_ptr<PostgresClockMarks>(
      new PostgresClockMarks(std::make_unique<Impl>(Impl{Link(*std::move(link), clock)})));
}

absl::StatusOr<ClockReading> PostgresClockMarks::Read() {
  const absl::StatusOr<Connection*> connection = impl_->link.Get();
  if (!connection.ok()) return connection.status();
  std::vector<StoreCall> calls;
  calls.push_back({kRead, {}});
  const auto answer = (*connection)->Run(calls, "read the mark of the clock");
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
