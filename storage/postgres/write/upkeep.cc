#include "storage/postgres/write/upkeep.h"

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <utility>
#include <vector>

#include "storage/bounds.h"
#include "storage/numbers.h"
#include "storage/postgres/tables/present_sql.h"
#include "storage/postgres/write/transaction.h"
#include "storage/rows.h"
#include "storage/shared_items.h"
#include "storage/store_rules.h"

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

// Of one robot. A session that is not kept has no row, or one that begins above the quarantine row;
// the statement sees both as of one moment. No Hello asks for what did not come by the relay.
// Without rows over the bound it stops at the count.
constexpr std::string_view kTrim =
    "WITH old AS (SELECT q.session, q.seq, q.entry, q.received_at"
    " FROM uplinkd.quarantine AS q LEFT JOIN uplinkd.sessions AS s ON s.ruri = q.ruri"
    " AND s.session = q.session AND q.entry >= s.first_entry"
    " WHERE q.ruri = $1::text AND (s.session IS NULL OR q.seq <= s.settled_seq OR q.source <> 0)"
    " ORDER BY s.session IS NOT NULL, q.entry LIMIT (SELECT least($3::bigint, greatest(0,"
    " count(*) - $2::bigint)) FROM uplinkd.quarantine WHERE ruri = $1::text)),"
    " went AS (DELETE FROM uplinkd.quarantine AS q USING old WHERE q.ruri = $1::text"
    " AND q.session = old.session AND q.seq = old.seq AND q.entry = old.entry"
    " AND q.received_at = old.received_at RETURNING q.reason),"
    " counted AS (SELECT reason, count(*) AS count FROM went GROUP BY reason),"
    " kept AS (INSERT INTO uplinkd.quarantine_dropped AS d (ruri, reason, count)"
    " SELECT $1::text, reason, count FROM counted"
    " ON CONFLICT (ruri, reason) DO UPDATE SET count = d.count + excluded.count)"
    " SELECT reason, count FROM counted";

constexpr std::string_view kSweepChanges =
    "SELECT uplinkd.sweep_changes($1::bigint, $2::int, $3::bigint)";

}  // namespace

StoreCall CloseRunsOver(const std::map<std::string_view, SystemTime>& robots) {
  Array ruri{Type::kText}, at{Type::kTime};
  for (const auto& [name, reported] : robots) {
    ruri.Text(name);
    at.Time(reported);
  }
  return StoreCallOf(kCloseOver, &ruri, &at, kOpenRunsPerRobotMax, kSweepRowsMax);
}

std::optional<std::size_t> PlaceOfCloseRunsOver(std::span<const StoreCall> calls) {
  for (std::size_t place = 0; place < calls.size(); ++place) {
    if (calls[place].sql.data() == kCloseOver.data()) return place;
  }
  return std::nullopt;
}

absl::StatusOr<std::size_t> CloseOldRuns(Connection& connection, SystemTime now,
                                         const std::function<absl::Status()>& before_commit) {
  const auto results =
      RunAndCommitFor(connection,
                      PipelineOf(StoreCallOf(kBegin),
                                 StoreCallOf(kCloseOld, now, now - kOpenRunAgeMax, kSweepRowsMax)),
                      "close mission runs", before_commit);
  if (!results.ok()) return Decisive(results.status());
  return (*results)[1].written();
}

absl::StatusOr<Trimmed> TrimQuarantine(Connection& connection, std::span<const std::string> ruris,
                                       const std::function<absl::Status()>& before_commit) {
  std::vector<StoreCall> calls;
  calls.push_back({kBegin, {}});
  for (const std::string& ruri : ruris) {
    calls.push_back(StoreCallOf(kTrim, ruri, kQuarantineRowsPerRobotMax, kTrimRowsMax));
  }
  const auto results =
      RunAndCommitFor(connection, std::move(calls), "trim the quarantine", before_commit);
  if (!results.ok()) return Decisive(results.status());
  Trimmed trimmed;
  for (std::size_t place = 0; place < ruris.size(); ++place) {
    std::size_t went = 0;
    for (const ResultRow& row : (*results)[place + 1]) {
      const auto count = static_cast<std::size_t>(row.Int(1));
      trimmed.dropped[static_cast<std::size_t>(ReasonOf(row.Int(0)))] += count;
      went += count;
    }
    if (went == kTrimRowsMax) trimmed.unfinished.push_back(place);
  }
  return trimmed;
}

absl::StatusOr<Swept> SweepRows(Connection& connection, SystemTime now, const StoreRules& rules,
                                const std::function<absl::Status()>& before_commit) {
  std::vector<StoreCall> calls;
  calls.push_back({kBegin, {}});
  const std::size_t first = calls.size();
  if (Vouches(rules.clock, now)) {
    for (const PresentKind kind : kItemKinds) {
      calls.push_back(
          StoreCallOf(PresentSqlOf(kind).sweep.view(), UnixMs(now - kExpiredKept), kSweepRowsMax));
    }
  }
  const std::size_t last = calls.size();
  // The last, so that the locks of items were taken by then. It goes by no clock of ours.
  calls.push_back(StoreCallOf(kSweepChanges, kChangesKept,
                              static_cast<std::int32_t>(kChangeWriterKept.count()),
                              kChangesSweptMax));
  const auto results = RunAndCommitFor(connection, std::move(calls), "sweep", before_commit);
  if (!results.ok()) return results.status();
  Swept swept;
  for (std::size_t i = first; i < last; ++i) swept.items += (*results)[i].written();
  swept.changes = static_cast<std::size_t>((*results)[last].Int(0, 0));
  return swept;
}

}  // namespace uplink::storage::postgres
