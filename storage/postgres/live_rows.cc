#include "storage/postgres/live_rows.h"

#include <algorithm>
#include <string>
#include <unordered_set>
#include <utility>

#include "storage/postgres/write/transaction.h"
#include "storage/reader.h"
#include "storage/sql_text.h"

namespace uplink::storage::postgres {
namespace {

constexpr std::string_view kDoing = "write a checkpoint";

// The first parameters are the columns before the parts, then come the parts, the session with its
// number, the process, and the number of the store call.
constexpr std::size_t kFirstPartParameter = 5;
constexpr std::size_t kSessionParameter = kFirstPartParameter + kLivePartKinds;
constexpr std::size_t kSettledParameter = kSessionParameter + 1;
constexpr std::size_t kProcessParameter = kSettledParameter + 1;
constexpr std::size_t kStoreCallParameter = kProcessParameter + 1;

/// The columns of `live` that a reading wants, in order.
constexpr SqlText Columns() {
  SqlText sql = {"ruri, held_since, last_sign_at, clock_skew_ms"};
  for (const LivePartRow& part : kLiveParts) sql.Add({", ", part.column});
  return sql;
}

// What did not change keeps its bytes: those that the database stores apart are not even read. In
// order of the keys, so that two processes do not lock each other out.
constexpr SqlText UpsertSql() {
  SqlText sql = {"INSERT INTO uplinkd.live AS l (", Columns().view(),
                 ", session, settled_seq, store_call, written_at) SELECT u.*, "};
  sql.AddParameter(kStoreCallParameter, "bigint");
  sql.Add(", now() FROM unnest($1::text[], $2::bigint[], $3::timestamptz[], $4::bigint[]");
  for (std::size_t i = 0; i < kLivePartKinds; ++i) {
    sql.Add(", ");
    sql.AddParameter(kFirstPartParameter + i, "bytea[]");
  }
  sql.Add(", ");
  sql.AddParameter(kSessionParameter, "uuid[]");
  sql.Add(", ");
  sql.AddParameter(kSettledParameter, "bigint[]");
  sql.Add({") AS u (", Columns().view(),
           ", session, settled_seq) JOIN uplinkd.robots AS r ON r.ruri = u.ruri"
           " AND r.held_since = u.held_since AND r.owner = "});
  sql.AddParameter(kProcessParameter, "uuid");
  // Whoever adopts a robot meanwhile waits, and then reads what was written.
  sql.Add(
      " ORDER BY r.ruri FOR SHARE OF r ON CONFLICT (ruri) DO UPDATE SET written_at = "
      "excluded.written_at, held_since = excluded.held_since, store_call = excluded.store_call,"
      " last_sign_at = coalesce(excluded.last_sign_at, l.last_sign_at),"
      " clock_skew_ms = coalesce(excluded.clock_skew_ms, l.clock_skew_ms),"
      " session = coalesce(excluded.session, l.session),"
      " settled_seq = coalesce(excluded.settled_seq, l.settled_seq)");
  for (const LivePartRow& part : kLiveParts) {
    sql.Add({", ", part.column, " = coalesce(excluded.", part.column, ", l.", part.column, ")"});
  }
  // One that was given up and runs late finds what came after it.
  sql.Add(
      " WHERE (l.held_since, l.store_call) < (excluded.held_since, excluded.store_call) RETURNING "
      "l.ruri");
  return sql;
}
constexpr SqlText kUpsert = UpsertSql();

// The lengths are known without reading the bytes.
constexpr SqlText ReadSql() {
  SqlText sql = {"SELECT ", Columns().view(),
                 ", found FROM (SELECT *, count(*) OVER () AS found, sum(bytes) OVER (ORDER BY "
                 "ruri) - bytes AS before FROM ("
                 "SELECT *, 0"};
  for (const LivePartRow& part : kLiveParts) {
    sql.Add({" + coalesce(octet_length(", part.column, "), 0)"});
  }
  sql.Add(
      " AS bytes FROM uplinkd.live WHERE ruri = ANY ($1::text[])) AS p)"
      " AS q WHERE before < $2::bigint ORDER BY ruri");
  return sql;
}
constexpr SqlText kReadOf = ReadSql();

constexpr int kFirstPart = 4;

std::vector<LiveRow> LiveRowsOf(const Result& rows) {
  std::vector<LiveRow> live(static_cast<std::size_t>(rows.rows()));
  for (int row = 0; row < rows.rows(); ++row) {
    LiveRow& one = live[static_cast<std::size_t>(row)];
    one.ruri = rows.Bytes(row, 0);
    one.held_since = static_cast<Epoch>(rows.Int(row, 1));
    if (!rows.Null(row, 2)) one.last_sign_of_life = rows.Time(row, 2);
    if (!rows.Null(row, 3)) one.clock_skew_ms = rows.Int(row, 3);
    for (std::size_t kind = 0; kind < kLivePartKinds; ++kind) {
      const int column = kFirstPart + static_cast<int>(kind);
      if (!rows.Null(row, column)) one.parts[kind] = rows.Bytes(row, column);
    }
  }
  return live;
}

}  // namespace

absl::StatusOr<std::vector<std::size_t>> WriteLive(
    Connection& connection, std::span<const LiveRow> rows, const LiveWriter& writer,
    const std::function<absl::Status()>& before_commit) {
  Array ruri{Type::kText}, held_since{Type::kInt8}, last_sign{Type::kTime}, skew{Type::kInt8};
  Array session{Type::kUuid}, settled{Type::kInt8};
  std::vector<Array> parts(kLivePartKinds, Array(Type::kBytes));
  for (const LiveRow& row : rows) {
    ruri.Text(row.ruri);
    held_since.Int8(static_cast<std::int64_t>(row.held_since));
    if (row.last_sign_of_life) {
      last_sign.Time(*row.last_sign_of_life);
    } else {
      last_sign.Null();
    }
    if (row.clock_skew_ms) {
      skew.Int8(*row.clock_skew_ms);
    } else {
      skew.Null();
    }
    if (row.session) {
      session.Uuid(row.session->session);
      settled.Int8(static_cast<std::int64_t>(row.session->settled_seq));
    } else {
      session.Null();
      settled.Null();
    }
    for (std::size_t kind = 0; kind < kLivePartKinds; ++kind) {
      if (row.parts[kind]) {
        parts[kind].Bytes(*row.parts[kind]);
      } else {
        parts[kind].Null();
      }
    }
  }
  std::vector<StoreCall> calls;
  calls.push_back({kBegin, {}});
  calls.push_back(StoreCallOf(kUpsert.view(), {&ruri, &held_since, &last_sign, &skew}));
  for (Array& part : parts) calls.back().parameters.Add(std::move(part));
  calls.back().parameters.Add(std::move(session));
  calls.back().parameters.Add(std::move(settled));
  calls.back().parameters.Uuid(model::SessionId(writer.process));
  calls.back().parameters.Int8(static_cast<std::int64_t>(writer.store_call));
  const auto results = RunAndCommitFor(connection, std::move(calls), kDoing, before_commit);
  if (!results.ok()) return Decisive(results.status());
  const Result& answer = (*results)[1];
  std::unordered_set<std::string_view> written;
  for (int row = 0; row < answer.rows(); ++row) written.insert(answer.Bytes(row, 0));
  std::vector<std::size_t> passed_over;
  for (std::size_t place = 0; place < rows.size(); ++place) {
    if (!written.contains(rows[place].ruri)) passed_over.push_back(place);
  }
  return passed_over;
}

absl::StatusOr<Reader::LiveRows> ReadLiveOf(Connection& connection,
                                            std::span<const std::string> ruris) {
  Array names{Type::kText};
  for (const std::string& ruri : ruris) names.Text(ruri);
  std::vector<StoreCall> calls;
  calls.push_back(StoreCallOf(kReadOf.view(), {&names}));
  calls.back().parameters.Int8(static_cast<std::int64_t>(kPageBytesMax));
  const auto results = connection.Run(calls, "read");
  if (!results.ok()) return results.status();
  const Result& answer = results->front();
  Reader::LiveRows live{LiveRowsOf(answer), ruris.size()};
  const int found_column = kFirstPart + static_cast<int>(kLivePartKinds);
  if (answer.rows() > 0 && answer.Int(0, found_column) > answer.rows()) {
    const auto last = std::ranges::find(ruris, live.rows.back().ruri);
    live.complete = static_cast<std::size_t>(last - ruris.begin()) + 1;
  }
  return live;
}

}  // namespace uplink::storage::postgres
