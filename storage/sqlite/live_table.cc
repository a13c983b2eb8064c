#include "storage/sqlite/live_table.h"

#include <string>
#include <utility>

#include "storage/sqlite/prepare.h"

namespace uplink::storage::sqlite {
namespace {

/// The columns of the parts, each behind a comma.
std::string PartColumns() {
  std::string columns;
  for (const LivePartRow& part : kLiveParts) columns.append(", ").append(part.column);
  return columns;
}

/// Behind those of the parts: session and settled_seq.
constexpr std::size_t kSessionColumns = 2;

// Only the holder's row of robots lets anything through.
std::string UpsertSql() {
  std::string sql = "INSERT INTO live (ruri, last_sign_ms, clock_skew_ms" + PartColumns() +
                    ", session, settled_seq) SELECT ?1, ?3, ?4";
  for (std::size_t i = 0; i < kLivePartKinds + kSessionColumns; ++i) sql += ", ?";
  sql +=
      " WHERE EXISTS (SELECT 1 FROM robots WHERE ruri = ?1 AND owner = ?2)"
      " ON CONFLICT (ruri) DO UPDATE SET"
      " last_sign_ms = coalesce(excluded.last_sign_ms, last_sign_ms),"
      " clock_skew_ms = coalesce(excluded.clock_skew_ms, clock_skew_ms),"
      " session = coalesce(excluded.session, session),"
      " settled_seq = coalesce(excluded.settled_seq, settled_seq)";
  for (const LivePartRow& part : kLiveParts) {
    const std::string column(part.column);
    sql.append(", ").append(column).append(" = coalesce(excluded.").append(column);
    sql.append(", ").append(column).append(")");
  }
  return sql + " RETURNING 1";
}

std::string ReadSql(std::string_view which) {
  return "SELECT ruri, last_sign_ms, clock_skew_ms" + PartColumns() + " FROM live WHERE " +
         std::string(which);
}

constexpr int kFirstPartBound = 5;
constexpr int kFirstPartRead = 3;

LiveRow LiveRowOf(Rows& rows) {
  LiveRow row;
  row.ruri = rows.Bytes(0);
  if (!rows.Null(1)) row.last_sign_of_life = FromUnixMs(rows.Int(1));
  if (!rows.Null(2)) row.clock_skew_ms = rows.Int(2);
  int column = kFirstPartRead;
  for (std::optional<std::string>& part : row.parts) {
    if (!rows.Null(column)) part = rows.Bytes(column);
    ++column;
  }
  return row;
}

void BindNumber(Statement& statement, int index, const std::optional<std::int64_t>& number) {
  if (number) {
    statement.Bind(index, *number);
  } else {
    statement.Bind(index, Blob{});
  }
}

}  // namespace

absl::Status LiveTable::Prepare(Database& database) {
  Preparer prepare(database);
  prepare.Into(upsert_, UpsertSql());
  return prepare.status();
}

absl::StatusOr<bool> LiveTable::Upsert(const LiveRow& row, const ProcessId& process) {
  upsert_->Bind(1, std::string_view(row.ruri));
  upsert_->Bind(
      2, Blob{std::string_view(reinterpret_cast<const char*>(process.data()), process.size())});
  std::optional<std::int64_t> last_sign_ms;
  if (row.last_sign_of_life) last_sign_ms = UnixMs(*row.last_sign_of_life);
  BindNumber(*upsert_, 3, last_sign_ms);
  BindNumber(*upsert_, 4, row.clock_skew_ms);
  int index = kFirstPartBound;
  for (const std::optional<std::string>& part : row.parts) {
    Blob blob;
    if (part) blob.bytes = *part;
    upsert_->Bind(index++, blob);
  }
  Blob session;
  std::optional<std::int64_t> settled_seq;
  if (row.session) {
    session.bytes = row.session->session.AsBytes();
    settled_seq = static_cast<std::int64_t>(row.session->settled_seq);
  }
  upsert_->Bind(index++, session);
  BindNumber(*upsert_, index, settled_seq);
  return upsert_->Select().Next();
}

absl::StatusOr<std::vector<LiveRow>> ReadLive(Database& database, std::string_view after) {
  auto statement = database.Prepare(ReadSql("ruri > ? ORDER BY ruri LIMIT ?"));
  if (!statement.ok()) return statement.status();
  Rows rows = (*statement)->Select(after, std::int64_t{kLiveRowsMax});
  std::vector<LiveRow> live;
  std::size_t bytes = 0;
  while (bytes < kPageBytesMax) {
    const absl::StatusOr<bool> found = rows.Next();
    if (!found.ok()) return found.status();
    if (!*found) break;
    live.push_back(LiveRowOf(rows));
    bytes += rows.TextBytes();
  }
  return live;
}

absl::StatusOr<Reader::LiveRows> ReadLiveOf(Database& database,
                                            std::span<const std::string> ruris) {
  auto statement = database.Prepare(ReadSql("ruri = ?"));
  if (!statement.ok()) return statement.status();
  Reader::LiveRows live;
  std::size_t bytes = 0;
  for (const std::string& ruri : ruris) {
    if (bytes >= kPageBytesMax) break;
    Rows rows = (*statement)->Select(std::string_view(ruri));
    const absl::StatusOr<bool> found = rows.Next();
    if (!found.ok()) return found.status();
    ++live.complete;
    if (!*found) continue;
    live.rows.push_back(LiveRowOf(rows));
    bytes += rows.TextBytes();
  }
  return live;
}

}  // namespace uplink::storage::sqlite
