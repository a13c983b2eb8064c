#include "tests/bench/bare_postgres.h"

#include <libpq-fe.h>

#include "schema/base/check.h"
#include "schema/base/clock.h"
#include "storage/postgres/link/parameters.h"

namespace uplink::bench {
namespace {

using storage::postgres::Array;
using storage::postgres::EncodeInt8;
using storage::postgres::Type;

constexpr int kBinary = 1;
/// Who holds its robots, and since when.
constexpr std::int64_t kHold = 1;
constexpr const char* kOwner = "07000000-0000-0000-0000-000000000000";
/// Places of what changes in each batch.
constexpr std::size_t kFirstsAt = 4;
constexpr std::size_t kSeqAt = 5;
constexpr std::size_t kCursorAt = 2;

constexpr const char* kBegin =
    "SELECT uplinkd.begin_batch($1::text[], $2::bigint[], $3::text[], $4::uuid[], $5::bigint[],"
    " '{}', '{}', '{}', '{}', 10000, 10000, 10000, NULL, NULL, $6::uuid)";
constexpr const char* kInsert =
    "INSERT INTO uplinkd.messages (ruri, received_at, entry, fleet, session, seq, sampled_ms,"
    " level, message)"
    " SELECT ruri, received_at, (SELECT currval('uplinkd.batches') << 20) + place, fleet, session,"
    " seq, sampled_ms, level, message"
    " FROM unnest($1::text[], $2::timestamptz[], $3::int[], $4::text[], $5::uuid[], $6::bigint[],"
    " $7::bigint[], $8::int[], $9::text[])"
    " AS u (ruri, received_at, place, fleet, session, seq, sampled_ms, level, message)";
constexpr const char* kRaise =
    "UPDATE uplinkd.sessions AS s SET cursor_seq = greatest(s.cursor_seq, old.to_seq),"
    " last_used = greatest(s.last_used, old.used)"
    " FROM (SELECT p.ruri, p.session, p.part, u.to_seq, u.used"
    " FROM unnest($1::text[], $2::uuid[], $3::bigint[], $4::timestamptz[])"
    " AS u (ruri, session, to_seq, used) CROSS JOIN LATERAL (SELECT l.ruri, l.session, l.part"
    " FROM uplinkd.sessions AS l WHERE l.ruri = u.ruri AND l.session = u.session"
    " ORDER BY l.part DESC LIMIT 1) AS p) AS old"
    " WHERE s.ruri = old.ruri AND s.session = old.session AND s.part = old.part";
constexpr const char* kForgetSessions =
    "DELETE FROM uplinkd.sessions AS s USING unnest($1::text[], $2::uuid[]) AS u (ruri, session)"
    " WHERE s.ruri = u.ruri AND s.session = u.session";
constexpr const char* kOpenSessions =
    "INSERT INTO uplinkd.sessions SELECT ruri, session, 0, now(), 0"
    " FROM unnest($1::text[], $2::uuid[]) AS u (ruri, session)";
constexpr const char* kSettings =
    "SET synchronous_commit = on; SET plan_cache_mode = force_generic_plan; SET enable_seqscan ="
    " off; SET enable_hashjoin = off; SET enable_mergejoin = off; SET jit = off;"
    " SET enable_bitmapscan = off;"
    " SET client_min_messages = warning";

void Execute(pg_conn* connection, const std::string& sql) {
  PGresult* const result = PQexec(connection, sql.c_str());
  const ExecStatusType status = PQresultStatus(result);
  UPLINK_CHECK(status == PGRES_COMMAND_OK || status == PGRES_TUPLES_OK, PQerrorMessage(connection));
  PQclear(result);
}

}  // namespace

void BarePostgres::Close::operator()(pg_conn* connection) const { PQfinish(connection); }

BarePostgres::BarePostgres(const std::string& url, const LoadShape& shape, std::size_t writer)
    : connection_(PQconnectdb(url.c_str())), shape_(shape) {
  pg_conn* const connection = connection_.get();
  UPLINK_CHECK(PQstatus(connection) == CONNECTION_OK, PQerrorMessage(connection));
  Execute(connection, kSettings);
  session_ = std::string(1, '\2') + std::string(15, static_cast<char>(writer));
  const std::size_t count = (shape.batch_records + shape.per_robot - 1) / shape.per_robot;
  const std::string at = "2025-11-21 12:00Z";
  for (std::size_t i = 0; i < count; ++i) {
    // Named as what is no robot: the server that is measured beside this adopts none of them.
    robots_.push_back("cyberwave:bench.rcan/uplink/synthetic/1.0/bare-" + std::to_string(writer) +
                      "-robot-" + std::to_string(i));
    Execute(connection, "INSERT INTO uplinkd.robots VALUES ('" + robots_.back() +
                            "', 'bench', 1, 1, '" + kOwner +
                            "', now(), now()) ON CONFLICT DO NOTHING");
  }
  Array ruri(Type::kText), held(Type::kInt8), sessions(Type::kUuid), used(Type::kTime);
  Array row_ruri(Type::kText), row_at(Type::kTime), place(Type::kInt4), fleet(Type::kText),
      row_session(Type::kUuid), sampled(Type::kInt8), level(Type::kInt4), text(Type::kText);
  // Today's partition, as the store's.
  const SystemTime now = SystemClock{}.System();
  for (const std::string& robot : robots_) {
    ruri.Text(robot);
    held.Int8(kHold);
    sessions.Bytes(session_);
    used.Time(now);
  }
  for (std::size_t i = 0; i < shape.batch_records; ++i) {
    row_ruri.Text(robots_[i / shape.per_robot]);
    row_at.Time(now);
    place.Int4(static_cast<std::int32_t>(i));
    fleet.Text("bench");
    row_session.Bytes(session_);
    sampled.Int8(UnixMs(now));
    level.Int4(0);
    text.Text(std::string(shape.text_bytes, 'm'));
  }
  const std::string robot_array = std::move(ruri).Take();
  const std::string session_array = std::move(sessions).Take();
  // Its binary form.
  const std::string owner = std::string(1, '\7') + std::string(15, '\0');
  begin_values_ = {robot_array, std::move(held).Take(), robot_array, session_array, "", owner};
  insert_values_ = {
      std::move(row_ruri).Take(), std::move(row_at).Take(),      std::move(place).Take(),
      std::move(fleet).Take(),    std::move(row_session).Take(), "",
      std::move(sampled).Take(),  std::move(level).Take(),       std::move(text).Take()};
  raise_values_ = {robot_array, session_array, "", std::move(used).Take()};
  const char* const values[] = {robot_array.data(), session_array.data()};
  const int lengths[] = {static_cast<int>(robot_array.size()),
                         static_cast<int>(session_array.size())};
  const int formats[] = {kBinary, kBinary};
  for (const char* sql : {kForgetSessions, kOpenSessions}) {
    PGresult* const opened =
        PQexecParams(connection, sql, 2, nullptr, values, lengths, formats, kBinary);
    UPLINK_CHECK(PQresultStatus(opened) == PGRES_COMMAND_OK, PQerrorMessage(connection));
    PQclear(opened);
  }
  for (const auto& [name, sql] :
       {std::pair{"b", "BEGIN"}, std::pair{"c", "COMMIT"}, std::pair{"begin", kBegin},
        std::pair{"insert", kInsert}, std::pair{"raise", kRaise}}) {
    PGresult* const prepared = PQprepare(connection, name, sql, 0, nullptr);
    UPLINK_CHECK(PQresultStatus(prepared) == PGRES_COMMAND_OK, PQerrorMessage(connection));
    PQclear(prepared);
  }
  UPLINK_CHECK(PQenterPipelineMode(connection) == 1, "a pipeline");
}

void BarePostgres::Send(const char* name, const std::vector<std::string>& values) {
  std::vector<const char*> pointers;
  std::vector<int> lengths;
  pointers.reserve(values.size());
  lengths.reserve(values.size());
  for (const std::string& value : values) {
    pointers.push_back(value.data());
    lengths.push_back(static_cast<int>(value.size()));
  }
  const std::vector<int> formats(values.size(), kBinary);
  UPLINK_CHECK(PQsendQueryPrepared(connection_.get(), name, static_cast<int>(values.size()),
                                   pointers.data(), lengths.data(), formats.data(), kBinary) == 1,
               PQerrorMessage(connection_.get()));
}

void BarePostgres::ReadToSync() {
  while (true) {
    PGresult* const result = PQgetResult(connection_.get());
    if (result == nullptr) continue;
    const ExecStatusType status = PQresultStatus(result);
    UPLINK_CHECK(
        status == PGRES_COMMAND_OK || status == PGRES_TUPLES_OK || status == PGRES_PIPELINE_SYNC,
        PQerrorMessage(connection_.get()));
    PQclear(result);
    if (status == PGRES_PIPELINE_SYNC) return;
  }
}

std::size_t BarePostgres::CommitOne() {
  Array firsts(Type::kInt8), seqs(Type::kInt8), cursors(Type::kInt8);
  for (std::size_t i = 0; i < robots_.size(); ++i) {
    firsts.Int8(base_ + 1);
    cursors.Int8(base_ + shape_.per_robot);
  }
  for (std::size_t i = 0; i < shape_.batch_records; ++i) {
    seqs.Int8(base_ + i % shape_.per_robot + 1);
  }
  base_ += shape_.per_robot;
  begin_values_[kFirstsAt] = std::move(firsts).Take();
  insert_values_[kSeqAt] = std::move(seqs).Take();
  raise_values_[kCursorAt] = std::move(cursors).Take();
  Send("b", {});
  Send("begin", begin_values_);
  Send("insert", insert_values_);
  Send("raise", raise_values_);
  Send("c", {});
  UPLINK_CHECK(PQpipelineSync(connection_.get()) == 1, "a sync");
  ReadToSync();
  return shape_.batch_records;
}

}  // namespace uplink::bench
