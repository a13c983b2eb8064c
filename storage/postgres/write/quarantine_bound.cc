#include "storage/postgres/write/quarantine_bound.h"

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <utility>
#include <vector>

#include "storage/bounds.h"
#include "storage/numbers.h"
#include "storage/postgres/write/transaction.h"

namespace uplink::storage::postgres {
namespace {

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

}  // namespace

absl::StatusOr<Trimmed> TrimQuarantine(Connection& connection, std::span<const std::string> ruris,
                                       const std::function<absl::Status()>& before_commit) {
  std::vector<StoreCall> calls;
  calls.push_back({kBegin, {}});
  for (const std::string& ruri : ruris) {
    StoreCall call{kTrim, {}};
    call.parameters.Text(ruri);
    call.parameters.Int8(static_cast<std::int64_t>(kQuarantineRowsPerRobotMax));
    call.parameters.Int8(static_cast<std::int64_t>(kTrimRowsMax));
    calls.push_back(std::move(call));
  }
  const auto results =
      RunAndCommitFor(connection, std::move(calls), "trim the quarantine", before_commit);
  if (!results.ok()) return Decisive(results.status());
  Trimmed trimmed;
  for (std::size_t place = 0; place < ruris.size(); ++place) {
    const Result& rows = (*results)[place + 1];
    std::size_t went = 0;
    for (int row = 0; row < rows.rows(); ++row) {
      const auto count = static_cast<std::size_t>(rows.Int(row, 1));
      trimmed.dropped[static_cast<std::size_t>(ReasonOf(rows.Int(row, 0)))] += count;
      went += count;
    }
    if (went == kTrimRowsMax) trimmed.unfinished.push_back(place);
  }
  return trimmed;
}

}  // namespace uplink::storage::postgres
