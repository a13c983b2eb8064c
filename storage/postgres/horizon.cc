#include "storage/postgres/horizon.h"

#include <chrono>
#include <utility>
#include <vector>

namespace uplink::storage::postgres {
namespace {

// Sessions of other databases hold back nothing here, but for those that send the log (they have no
// database) and for slots. A VACUUM's snapshot holds back nothing either.
constexpr std::string_view kAsk =
    "WITH held AS (SELECT x FROM pg_stat_activity AS a CROSS JOIN LATERAL"
    " (VALUES (a.backend_xid), (a.backend_xmin)) AS v (x) WHERE a.pid <> pg_backend_pid()"
    " AND (a.datid IS NULL OR a.datname = current_database())"
    " AND NOT EXISTS (SELECT FROM pg_stat_progress_vacuum AS v WHERE v.pid = a.pid)"
    " UNION ALL SELECT s.xmin FROM pg_replication_slots AS s"
    " UNION ALL SELECT p.transaction FROM pg_prepared_xacts AS p"
    " WHERE p.database = current_database())"
    " SELECT pg_snapshot_xmax(pg_current_snapshot())::text::bigint & 4294967295,"
    " (SELECT h.x::text::bigint FROM held AS h WHERE h.x IS NOT NULL"
    " ORDER BY age(h.x) DESC LIMIT 1)";

/// As the server compares them: half of the numbers lie before any one.
bool Precedes(std::uint32_t left, std::uint32_t right) {
  return static_cast<std::int32_t>(left - right) < 0;
}

}  // namespace

absl::StatusOr<Horizon> ReadHorizon(Connection& connection) {
  std::vector<StoreCall> calls;
  calls.push_back({kAsk, {}});
  const auto answer = connection.Run(calls, "ask for the oldest snapshot");
  if (!answer.ok()) return answer.status();
  const Result& row = answer->front();
  Horizon horizon{static_cast<std::uint32_t>(row.Int(0, 0)), std::nullopt};
  if (!row.Null(0, 1)) horizon.oldest = static_cast<std::uint32_t>(row.Int(0, 1));
  return horizon;
}

milliseconds HorizonAge::Note(const Horizon& horizon, SteadyTime now) {
  const std::uint32_t oldest = horizon.oldest.value_or(horizon.next);
  while (!seen_.empty() && !Precedes(oldest, seen_.front().next)) seen_.pop_front();
  if (seen_.empty()) spacing_ = {};
  if (Precedes(oldest, horizon.next) && IsDue(horizon, now)) {
    if (seen_.size() == kSeenMax) Thin();
    seen_.push_back({now, horizon.next});
  }
  if (seen_.empty()) return milliseconds(0);
  return std::chrono::duration_cast<milliseconds>(now - seen_.front().at);
}

bool HorizonAge::IsDue(const Horizon& horizon, SteadyTime now) const {
  if (seen_.empty()) return true;
  return Precedes(seen_.back().next, horizon.next) && now - seen_.back().at >= spacing_;
}

void HorizonAge::Thin() {
  spacing_ = (seen_.back().at - seen_.front().at) / (kSeenMax / 2);
  std::deque<Seen> thinned;
  for (std::size_t i = 0; i < seen_.size(); i += 2) thinned.push_back(seen_[i]);
  seen_ = std::move(thinned);
}

}  // namespace uplink::storage::postgres
