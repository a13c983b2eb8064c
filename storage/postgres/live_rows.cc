#include "storage/postgres/live_rows.h"

#include <algorithm>
#include <string>
#include <unordered_set>
#include <utility>

#include "storage/postgres/transaction.h"
#include "storage/reader.h"

namespace uplink::storage::postgres {
namespace {

constexpr std::string_view kDoing = "write a checkpoint";

// What did not change keeps its bytes: those that the database stores apart are not even read. In
// order of the keys, so that two processes do not lock each other out.
constexpr std::string_view kUpsert =
    "INSERT INTO uplinkd.live AS l (ruri, last_sign_at, clock_skew_ms, motion, status, extras,"
    " health, usage, consumables, directives, rcan)"
    " SELECT u.* FROM unnest($1::text[], $2::timestamptz[], $3::bigint[], $4::bytea[],"
    " $5::bytea[], $6::bytea[], $7::bytea[], $8::bytea[], $9::bytea[], $10::bytea[], $11::bytea[])"
    " AS u (ruri, last_sign_at, clock_skew_ms, motion, status, extras, health, usage, consumables,"
    " directives, rcan) JOIN uplinkd.robots AS r ON r.ruri = u.ruri AND r.owner = $12::uuid"
    " ORDER BY u.ruri"
    " ON CONFLICT (ruri) DO UPDATE SET"
    " last_sign_at = coalesce(excluded.last_sign_at, l.last_sign_at),"
    " clock_skew_ms = coalesce(excluded.clock_skew_ms, l.clock_skew_ms),"
    " motion = coalesce(excluded.motion, l.motion), status = coalesce(excluded.status, l.status),"
    " extras = coalesce(excluded.extras, l.extras), health = coalesce(excluded.health, l.health),"
    " usage = coalesce(excluded.usage, l.usage),"
    " consumables = coalesce(excluded.consumables, l.consumables),"
    " directives = coalesce(excluded.directives, l.directives),"
    " rcan = coalesce(excluded.rcan, l.rcan) RETURNING ruri";
// The lengths are known without reading the bytes.
constexpr std::string_view kRead =
    "SELECT ruri, last_sign_at, clock_skew_ms, motion, status, extras, health, usage, consumables,"
    " directives, rcan FROM (SELECT *, sum(bytes) OVER (ORDER BY ruri) - bytes AS before FROM ("
    "SELECT *, coalesce(octet_length(motion), 0) + coalesce(octet_length(status), 0)"
    " + coalesce(octet_length(extras), 0) + coalesce(octet_length(health), 0)"
    " + coalesce(octet_length(usage), 0) + coalesce(octet_length(consumables), 0)"
    " + coalesce(octet_length(directives), 0) + coalesce(octet_length(rcan), 0) AS bytes"
    " FROM uplinkd.live WHERE ruri > $1::text ORDER BY ruri LIMIT $2::bigint) AS p) AS q"
    " WHERE before < $3::bigint ORDER BY ruri";

constexpr int kFirstPart = 3;

}  // namespace

absl::StatusOr<std::vector<std::size_t>> WriteLive(
    Connection& connection, std::span<const LiveRow> rows, const ProcessId& process,
    const std::function<absl::Status()>& before_commit) {
  Array ruri{Type::kText}, last_sign{Type::kTime}, skew{Type::kInt8};
  std::vector<Array> parts(kLivePartKinds, Array(Type::kBytes));
  for (const LiveRow& row : rows) {
    ruri.Text(row.ruri);
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
    for (std::size_t kind = 0; kind < kLivePartKinds; ++kind) {
      if (row.parts[kind]) {
        parts[kind].Bytes(*row.parts[kind]);
      } else {
        parts[kind].Null();
      }
    }
  }
  std::vector<Call> calls;
  calls.push_back({kBegin, {}});
  calls.push_back(CallOf(kUpsert, {&ruri, &last_sign, &skew}));
  for (Array& part : parts) calls.back().parameters.Add(std::move(part));
  calls.back().parameters.Uuid(model::SessionId(process));
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

absl::StatusOr<std::vector<LiveRow>> ReadLive(Connection& connection, std::string_view after) {
  std::vector<Call> calls;
  calls.push_back({kRead, {}});
  calls.back().parameters.Text(after);
  calls.back().parameters.Int8(std::int64_t{kLiveRowsMax});
  calls.back().parameters.Int8(static_cast<std::int64_t>(kPageBytesMax));
  const auto results = connection.Run(calls, "read");
  if (!results.ok()) return results.status();
  const Result& rows = results->front();
  std::vector<LiveRow> live(static_cast<std::size_t>(rows.rows()));
  for (int row = 0; row < rows.rows(); ++row) {
    LiveRow& one = live[static_cast<std::size_t>(row)];
    one.ruri = rows.Bytes(row, 0);
    if (!rows.Null(row, 1)) one.last_sign_of_life = rows.Time(row, 1);
    if (!rows.Null(row, 2)) one.clock_skew_ms = rows.Int(row, 2);
    for (std::size_t kind = 0; kind < kLivePartKinds; ++kind) {
      const int column = kFirstPart + static_cast<int>(kind);
      if (!rows.Null(row, column)) one.parts[kind] = rows.Bytes(row, column);
    }
  }
  return live;
}

}  // namespace uplink::storage::postgres
