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

constexpr int kFirstPartBound = 5;
/// Behind those of the parts: session, settled_seq and held_since.
constexpr std::size_t kLastColumns = 3;

// Only the holder's row of robots lets anything through.
std::string UpsertSql() {
  std::string sql = "INSERT INTO live (ruri, last_sign_at, clock_skew_ms" + PartColumns() +
                    ", session, settled_seq, held_since) SELECT ?1, ?3, ?4";
  for (std::size_t i = 0; i < kLivePartKinds + kLastColumns; ++i) sql += ", ?";
  sql += " WHERE EXISTS (SELECT 1 FROM robots WHERE ruri = ?1 AND owner = ?2 AND held_since = ";
  sql += "?" + std::to_string(kFirstPartBound + kLivePartKinds + kLastColumns - 1);
  sql +=
      ") ON CONFLICT (ruri) DO UPDATE SET held_since = excluded.held_since,"
      " last_sign_at = coalesce(excluded.last_sign_at, last_sign_at),"
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

constexpr int kFirstPartRead = 4;

LiveRow LiveRowOf(Rows& rows) {
  LiveRow row;
  row.ruri = rows.Bytes(0);
  row.held_since = static_cast<Epoch>(rows.Int(1));
  if (!rows.Null(2)) row.last_sign_of_life = FromUnixMs(rows.Int(2));
  if (!rows.Null(3)) row.clock_skew_ms = rows.Int(3);
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
  BindNumber(*upsert_, index++, settled_seq);
  upsert_->Bind(index, row.held_since);
  return upsert_->Select().Next();
}

absl::StatusOr<Reader::LiveRows> ReadLiveOf(Database& database,
                                            std::span<const std::string> ruris) {
  auto statement = database.Prepare("SELECT ruri, held_since, last_sign_at, clock_skew_ms" +
                                    PartColumns() + " FROM live WHERE ruri = ?");
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
