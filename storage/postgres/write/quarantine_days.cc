#include "storage/postgres/write/quarantine_days.h"

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <utility>

#include "storage/bounds.h"
#include "storage/postgres/write/transaction.h"
#include "storage/retention.h"

namespace uplink::storage::postgres {
namespace {

constexpr std::string_view kDoing = "keep the quarantine";
/// Days that one call drops, before the journal's turn ends.
constexpr std::size_t kDaysPerCallMax = 10;
constexpr std::string_view kTake =
    "SELECT day IS NOT NULL, first_at, taken, kept FROM uplinkd.take_quarantine("
    "($1::timestamptz AT TIME ZONE 'UTC')::date, $2::timestamptz, $3::int)";
constexpr std::string_view kDrop =
    "SELECT uplinkd.drop_partitions('quarantine', ($1::timestamptz AT TIME ZONE 'UTC')::date)";
/// What arrived outside the partitions of days. As take_quarantine, it keeps the Rejects that a
/// Hello may still ask for.
constexpr std::string_view kEraseDefault =
    "WITH went AS (DELETE FROM uplinkd.quarantine_default WHERE ctid = ANY (ARRAY("
    "SELECT ctid FROM uplinkd.quarantine_default WHERE received_at < $1::timestamptz"
    " ORDER BY received_at, entry LIMIT $2::bigint))"
    " RETURNING ruri, session, seq, entry, source, reason, field, detail),"
    " kept AS (INSERT INTO uplinkd.kept_rejects"
    " (ruri, session, last, first, entry, reason, field, detail)"
    " SELECT q.ruri, q.session, q.seq, q.seq, q.entry, q.reason, q.field, q.detail FROM went AS q"
    " CROSS JOIN LATERAL (SELECT l.first_entry, l.settled_seq FROM uplinkd.sessions AS l"
    " WHERE l.ruri = q.ruri AND l.session = q.session ORDER BY l.part DESC LIMIT 1) AS s"
    " WHERE q.source = 0 AND q.entry >= s.first_entry AND q.seq > s.settled_seq"
    " ON CONFLICT DO NOTHING RETURNING 1)"
    " SELECT (SELECT count(*) FROM went), (SELECT count(*) FROM kept)";

std::size_t Count(const Result& result, int column) {
  return static_cast<std::size_t>(result.Int(0, column));
}

StoreCall CallOf(std::string_view sql, SystemTime until) {
  StoreCall call{sql, {}};
  call.parameters.Time(until);
  return call;
}

}  // namespace

absl::StatusOr<Erased> QuarantineDays::Erase(Connection& connection, SystemTime until) {
  Erased erased;
  const absl::Status emptied = EmptyDays(connection, until, erased);
  if (!emptied.ok()) return emptied;
  StoreCall call = CallOf(kEraseDefault, until);
  call.parameters.Int8(static_cast<std::int64_t>(kRetainRowsMax));
  const auto others = RunAlone(connection, std::move(call), kDoing);
  if (!others.ok()) return others.status();
  const std::size_t rows = Count(*others, 0);
  erased.rows += rows;
  erased.rejects_kept += Count(*others, 1);
  if (rows == kRetainRowsMax) erased.more = true;
  return erased;
}

absl::Status QuarantineDays::EmptyDays(Connection& connection, SystemTime until, Erased& erased) {
  std::size_t rows = 0;
  std::size_t days = 0;
  while (rows < kRetainRowsMax && days < kDaysPerCallMax) {
    StoreCall take = CallOf(kTake, until);
    take.parameters.Time(since_);
    take.parameters.Int4(static_cast<std::int32_t>(kRetainRowsMax - rows));
    const auto taken = RunAlone(connection, std::move(take), kDoing);
    if (!taken.ok()) return taken.status();
    if (!taken->Bool(0, 0)) {
      since_ = SystemTime();
      return absl::OkStatus();
    }
    const std::size_t went = Count(*taken, 2);
    const SystemTime looked_from = std::exchange(since_, went > 0 ? taken->Time(0, 1) : since_);
    rows += went;
    erased.rows += went;
    erased.rejects_kept += Count(*taken, 3);
    if (rows == kRetainRowsMax) break;
    const auto dropped = RunAlone(connection, CallOf(kDrop, until), kDoing);
    if (!dropped.ok()) return dropped.status();
    days += Count(*dropped, 0);
    erased.rows += Count(*dropped, 0);
    if (Count(*dropped, 0) > 0) continue;
    // A row that was committed late lies before what was looked at, or came just now.
    since_ = SystemTime();
    if (looked_from == SystemTime()) break;
  }
  erased.more = true;
  return absl::OkStatus();
}

}  // namespace uplink::storage::postgres
