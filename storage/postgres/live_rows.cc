#include "storage/postgres/live_rows.h"

#include <algorithm>
#include <string_view>
#include <unordered_set>

#include "storage/postgres/tables/insert.h"
#include "storage/postgres/write/transaction.h"
#include "storage/read_row.h"
#include "storage/tables/live.h"

namespace uplink::storage::postgres {
namespace {

constexpr SqlText kColumns = LiveColumns();

constexpr std::string_view kHeldBy =
    ") JOIN uplinkd.robots AS r ON r.ruri = u.ruri AND r.held_since = u.held_since"
    " AND r.owner = ";

// What did not change keeps its bytes: those that the database stores apart are not even read. In
// order of the keys, so that two processes do not lock each other out. A process that adopts
// a robot meanwhile waits, and then reads what was written. A call that was given up and runs late
// finds what came after it.
constexpr SqlText UpsertSql() {
  const SqlText names = ColumnNames(kLiveTable);
  constexpr std::size_t kProcess = kLiveTable.columns.size() + 1;
  SqlText sql = {"INSERT INTO uplinkd.live AS t (", names.view(),
                 ", store_call, written_at) SELECT u.*, "};
  sql.AddParameter(kProcess + 1, "bigint");
  sql.Add(
      {", now() FROM unnest(", ArraysSql(kLiveTable).view(), ") AS u (", names.view(), kHeldBy});
  sql.AddParameter(kProcess, "uuid");
  sql.Add({" ORDER BY r.ruri FOR SHARE OF r", ConflictSql(kLiveTable).view(),
           ", written_at = excluded.written_at, store_call = excluded.store_call"
           " WHERE (t.held_since, t.store_call) < (excluded.held_since, excluded.store_call)"
           " RETURNING t.ruri"});
  return sql;
}
constexpr SqlText kUpsert = UpsertSql();

// The lengths are known without reading the bytes.
constexpr SqlText ReadSql() {
  SqlText sql = {"SELECT ", kColumns.view(),
                 ", found FROM (SELECT *, count(*) OVER () AS found,"
                 " sum(bytes) OVER (ORDER BY ruri) - bytes AS before FROM (SELECT *, 0"};
  for (const LivePartRow& part : kLiveParts) {
    sql.Add({" + coalesce(octet_length(", part.column, "), 0)"});
  }
  sql.Add(
      " AS bytes FROM uplinkd.live WHERE ruri = ANY ($1::text[])) AS p)"
      " AS q WHERE before < $2::bigint ORDER BY ruri");
  return sql;
}
constexpr SqlText kReadOf = ReadSql();

}  // namespace

absl::StatusOr<std::vector<std::size_t>> WriteLive(
    Connection& connection, std::span<const LiveRow> rows, const LiveWriter& writer,
    const std::function<absl::Status()>& before_commit) {
  StoreCall upsert = CallWithRows<kLiveTable>(kUpsert.view(), rows);
  upsert.parameters.Add(writer.process);
  upsert.parameters.Add(writer.store_call);
  const auto results =
      RunAndCommitFor(connection, PipelineOf(StoreCallOf(kBegin), std::move(upsert)),
                      "write a checkpoint", before_commit);
  if (!results.ok()) return Decisive(results.status());
  std::unordered_set<std::string_view> written;
  for (const ResultRow& row : (*results)[1]) written.insert(row.Bytes(0));
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
  const auto answer = connection.RunOne(StoreCallOf(kReadOf.view(), &names, kPageBytesMax), "read");
  if (!answer.ok()) return answer.status();
  Reader::LiveRows live{answer->All(LiveIn<ResultRow>), ruris.size()};
  const int found_column = kFirstLivePart + static_cast<int>(kLivePartKinds);
  if (answer->rows() > 0 && answer->Int(0, found_column) > answer->rows()) {
    const auto last = std::ranges::find(ruris, live.rows.back().ruri);
    live.complete = static_cast<std::size_t>(last - ruris.begin()) + 1;
  }
  return live;
}

}  // namespace uplink::storage::postgres
