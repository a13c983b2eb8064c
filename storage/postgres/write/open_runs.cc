#include "storage/postgres/write/open_runs.h"

#include <cstdint>
#include <utility>
#include <vector>

#include "storage/bounds.h"
#include "storage/postgres/write/transaction.h"

namespace uplink::storage::postgres {
namespace {

// By their places in the table: a join by their names was planned as all runs of the robot times
// those to close, until the table's first ANALYZE (95 ms per commit with 4,600 runs).
// closed_why is RunClosed::kForBound.
constexpr std::string_view kCloseOver =
    "UPDATE uplinkd.mission_runs AS m SET is_open = false, closed_why = 1, closed_at = u.at"
    " FROM unnest($1::text[], $2::timestamptz[]) AS u (ruri, at)"
    " WHERE m.ruri = u.ruri AND m.ctid = ANY (ARRAY (SELECT old.row"
    " FROM unnest($1::text[]) AS r (ruri) CROSS JOIN LATERAL"
    " (SELECT p.ctid AS row FROM uplinkd.mission_runs AS p WHERE p.ruri = r.ruri AND p.is_open"
    " ORDER BY p.last_entry DESC, p.last_at DESC, p.entry DESC"
    " OFFSET $3::bigint LIMIT $4::bigint) AS old))";

// closed_why is RunClosed::kForAge. A run's last report is hardly ever older than its first one, by
// which the index goes. What a batch of another shard reports meanwhile is passed over.
constexpr std::string_view kCloseOld =
    "UPDATE uplinkd.mission_runs AS m SET is_open = false, closed_why = 2,"
    " closed_at = $1::timestamptz FROM (SELECT ruri, mission_id, run_id FROM uplinkd.mission_runs"
    " WHERE is_open AND first_at < $2::timestamptz AND last_at < $2::timestamptz"
    " ORDER BY first_at, entry LIMIT $3::bigint FOR UPDATE SKIP LOCKED) AS old"
    " WHERE m.ruri = old.ruri AND m.mission_id = old.mission_id AND m.run_id = old.run_id";

}  // namespace

StoreCall CloseRunsOver(const std::map<std::string_view, SystemTime>& robots) {
  Array ruri{Type::kText}, at{Type::kTime};
  for (const auto& [name, reported] : robots) {
    ruri.Text(name);
    at.Time(reported);
  }
  StoreCall call = StoreCallOf(kCloseOver, {&ruri, &at});
  call.parameters.Int8(static_cast<std::int64_t>(kOpenRunsPerRobotMax));
  call.parameters.Int8(static_cast<std::int64_t>(kSweepRowsMax));
  return call;
}

std::optional<std::size_t> PlaceOfCloseRunsOver(std::span<const StoreCall> calls) {
  for (std::size_t place = 0; place < calls.size(); ++place) {
    if (calls[place].sql.data() == kCloseOver.data()) return place;
  }
  return std::nullopt;
}

absl::StatusOr<std::size_t> CloseOldRuns(Connection& connection, SystemTime now,
                                         const std::function<absl::Status()>& before_commit) {
  StoreCall call{kCloseOld, {}};
  call.parameters.Time(now);
  call.parameters.Time(now - kOpenRunAgeMax);
  call.parameters.Int8(static_cast<std::int64_t>(kSweepRowsMax));
  std::vector<StoreCall> calls;
  calls.push_back({kBegin, {}});
  calls.push_back(std::move(call));
  const auto results =
      RunAndCommitFor(connection, std::move(calls), "close mission runs", before_commit);
  if (!results.ok()) return Decisive(results.status());
  return (*results)[1].written();
}

}  // namespace uplink::storage::postgres
