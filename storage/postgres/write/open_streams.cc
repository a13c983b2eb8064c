#include "storage/postgres/write/open_streams.h"

#include <algorithm>
#include <map>
#include <string_view>
#include <utility>

#include "schema/base/check.h"
#include "storage/postgres/write/rejection_row.h"
#include "storage/postgres/write/stored_presence.h"
#include "storage/postgres/write/transaction.h"

namespace uplink::storage::postgres {
namespace {

constexpr std::string_view kDoing = "open streams";

// Epochs are drawn for each row alone, and with its lock held, so that of two that open a robot the
// later has the greater one. A new row is locked by being there: it is made with epoch 0, which
// says that it is new, and draws in the statement after. The right sides of an update see the row
// as it was; they name it in what draws, which would otherwise be done once for all rows. The epoch
// is above the row's last even where the sequence is not: logical replication leaves sequences
// behind.
constexpr std::string_view kOpenRobots =
    "INSERT INTO uplinkd.robots AS r (ruri, fleet, epoch, held_since, owner, first_seen, last_seen)"
    " SELECT ruri, fleet, 0, 0, $4::uuid, seen_at, seen_at"
    " FROM unnest($1::text[], $2::text[], $3::timestamptz[]) AS u (ruri, fleet, seen_at)"
    " ON CONFLICT (ruri) DO UPDATE SET fleet = excluded.fleet,"
    " (epoch, held_since) = (SELECT d.epoch,"
    " CASE WHEN r.owner = excluded.owner THEN r.held_since ELSE d.epoch END"
    " FROM (SELECT greatest(nextval('uplinkd.epochs'), r.epoch + 1) AS epoch) AS d),"
    " owner = excluded.owner, holder_silent = false, last_seen = greatest(r.last_seen, "
    "excluded.last_seen)"
    // A stream that has ended ($5) takes its robot from nobody who did not release its lease.
    " WHERE NOT (r.ruri = ANY ($5::text[]) AND r.owner <> excluded.owner AND EXISTS (SELECT 1"
    " FROM uplinkd.processes AS p WHERE p.process = r.owner AND NOT p.released))"
    " RETURNING ruri, epoch, held_since";
constexpr std::string_view kNumberNewRobots =
    "UPDATE uplinkd.robots AS r SET (epoch, held_since) = (SELECT d.epoch, d.epoch"
    " FROM (SELECT greatest(nextval('uplinkd.epochs'), r.epoch + 1) AS epoch) AS d)"
    " WHERE r.ruri = ANY ($1::text[]) AND r.epoch = 0 RETURNING r.ruri, r.epoch";
// A session's row is looked for from the greatest part down (see the migration of session parts).
// The robots' rows are locked by then, so nobody adds the same session meanwhile.
constexpr std::string_view kOpenSessions =
    "WITH u AS (SELECT * FROM unnest($1::text[], $2::uuid[], $3::timestamptz[], $5::bigint[])"
    " AS u (ruri, session, used, settled) WHERE EXISTS (SELECT 1 FROM uplinkd.robots AS r"
    " WHERE r.ruri = u.ruri AND r.owner = $4::uuid)),"
    " old AS MATERIALIZED (SELECT p.ruri, p.session, p.part, u.used, u.settled FROM u CROSS JOIN "
    "LATERAL"
    " (SELECT l.ruri, l.session, l.part FROM uplinkd.sessions AS l"
    " WHERE l.ruri = u.ruri AND l.session = u.session ORDER BY l.part DESC LIMIT 1) AS p),"
    " touched AS (UPDATE uplinkd.sessions AS s SET last_used = greatest(s.last_used, old.used),"
    " settled_seq = greatest(s.settled_seq, least(old.settled, s.cursor_seq))"
    " FROM old WHERE s.ruri = old.ruri AND s.session = old.session AND s.part = old.part"
    " RETURNING s.ruri, s.cursor_seq),"
    " made AS (INSERT INTO uplinkd.sessions (ruri, session, cursor_seq, last_used, first_entry)"
    " SELECT u.ruri, u.session, 0, u.used, (SELECT currval('uplinkd.batches') << 20) FROM u"
    " WHERE NOT EXISTS (SELECT FROM old WHERE old.ruri = u.ruri AND old.session = u.session)"
    " RETURNING ruri, cursor_seq)"
    " SELECT ruri, cursor_seq FROM touched UNION ALL SELECT ruri, cursor_seq FROM made";
constexpr std::string_view kReadRejects =
    "SELECT u.ruri, q.seq, q.reason, q.field, q.detail"
    " FROM unnest($1::text[], $2::uuid[], $3::bigint[]) AS u (ruri, session, settled)"
    " CROSS JOIN LATERAL (SELECT l.cursor_seq, l.first_entry FROM uplinkd.sessions AS l"
    " WHERE l.ruri = u.ruri AND l.session = u.session ORDER BY l.part DESC LIMIT 1) AS s"
    " CROSS JOIN LATERAL (SELECT p.seq, p.reason, p.field, p.detail FROM uplinkd.quarantine AS p"
    " WHERE p.ruri = u.ruri AND p.session = u.session AND p.seq > u.settled"
    " AND p.seq <= s.cursor_seq AND p.entry >= s.first_entry ORDER BY p.seq LIMIT $4::bigint) AS q"
    " ORDER BY u.ruri, q.seq";
// The same rows, which the primary key tells without the table.
constexpr std::string_view kCountRejects =
    "SELECT u.ruri, q.total"
    " FROM unnest($1::text[], $2::uuid[], $3::bigint[]) AS u (ruri, session, settled)"
    " CROSS JOIN LATERAL (SELECT l.cursor_seq, l.first_entry FROM uplinkd.sessions AS l"
    " WHERE l.ruri = u.ruri AND l.session = u.session ORDER BY l.part DESC LIMIT 1) AS s"
    " CROSS JOIN LATERAL (SELECT count(*) AS total FROM (SELECT FROM uplinkd.quarantine AS p"
    " WHERE p.ruri = u.ruri AND p.session = u.session AND p.seq > u.settled"
    " AND p.seq <= s.cursor_seq AND p.entry >= s.first_entry LIMIT $4::bigint) AS rows) AS q";
// Of each robot, the least recently used sessions over the bound that nobody holds. From one
// session to the next by its key, so that dead versions of their rows are passed over.
constexpr std::string_view kEvictSessions =
    "WITH RECURSIVE p AS (SELECT n.* FROM unnest($1::text[]) AS u (ruri)"
    " JOIN uplinkd.robots AS r ON r.ruri = u.ruri AND r.owner = $5::uuid CROSS JOIN LATERAL"
    " (SELECT l.ruri, l.session, l.part, l.last_used FROM uplinkd.sessions AS l"
    " WHERE l.ruri = u.ruri ORDER BY l.session DESC, l.part DESC LIMIT 1) AS n"
    " UNION ALL SELECT n.* FROM p CROSS JOIN LATERAL"
    " (SELECT l.ruri, l.session, l.part, l.last_used FROM uplinkd.sessions AS l"
    " WHERE l.ruri = p.ruri AND l.session < p.session"
    " ORDER BY l.session DESC, l.part DESC LIMIT 1) AS n)"
    " DELETE FROM uplinkd.sessions AS s USING ("
    "SELECT a.ruri, a.session, a.part, a.kept, row_number() OVER (PARTITION BY a.ruri"
    " ORDER BY a.last_used, a.session) AS place FROM (SELECT p.ruri, p.session, p.part,"
    " p.last_used,"
    " count(*) OVER (PARTITION BY p.ruri) AS kept FROM p) AS a WHERE a.kept > $4::bigint"
    " AND NOT EXISTS (SELECT 1 FROM unnest($2::text[], $3::uuid[]) AS held (ruri, session)"
    " WHERE held.ruri = a.ruri AND held.session = a.session)) AS old"
    " WHERE s.ruri = old.ruri AND s.session = old.session AND s.part = old.part"
    " AND old.place <= old.kept - $4::bigint";

// The primary key tells it without the table.
constexpr std::string_view kReadLatestKinds =
    "SELECT ruri, kind FROM uplinkd.latest WHERE ruri = ANY ($1::text[])";

/// Requests of different robots, by RURI.
using Wave = std::map<std::string_view, std::size_t>;

/// Puts each request into the first wave that does not name its robot yet.
std::vector<Wave> WavesOf(std::span<const OpenRequest> requests) {
  std::vector<Wave> waves;
  for (std::size_t i = 0; i < requests.size(); ++i) {
    const std::string_view ruri = requests[i].robot->ruri;
    auto wave = std::ranges::find_if(waves, [&](const Wave& one) { return !one.contains(ruri); });
    if (wave == waves.end()) wave = waves.emplace(waves.end());
    wave->emplace(ruri, i);
  }
  return waves;
}

std::vector<StoreCall> CallsOf(const Wave& wave, std::span<const OpenRequest> requests,
                               const ProcessId& process) {
  Array ruri{Type::kText}, fleet{Type::kText}, at{Type::kTime}, new_ruri{Type::kText},
      latest_ruri{Type::kText};
  Array session_ruri{Type::kText}, session{Type::kUuid}, used{Type::kTime}, told{Type::kInt8};
  Array settled_ruri{Type::kText}, settled_session{Type::kUuid}, settled{Type::kInt8};
  Array ended{Type::kText}, evict_ruri{Type::kText}, held_ruri{Type::kText},
      held_session{Type::kUuid};
  Array counted_ruri{Type::kText}, counted_session{Type::kUuid}, counted{Type::kInt8};
  std::size_t rejects_max = 0;
  std::vector<std::string_view> ruris;
  for (const auto& [name, index] : wave) {
    const OpenRequest& request = requests[index];
    ruris.push_back(name);
    ruri.Text(name);
    new_ruri.Text(name);
    latest_ruri.Text(name);
    fleet.Text(request.robot->fleet);
    at.Time(request.at);
    if (request.stream == StreamState::kEnded) ended.Text(name);
    session_ruri.Text(name);
    session.Uuid(request.session);
    used.Time(request.at);
    told.Int8(request.settled_seq);
    settled_ruri.Text(name);
    settled_session.Uuid(request.session);
    settled.Int8(request.settled_seq);
    counted_ruri.Text(name);
    counted_session.Uuid(request.session);
    counted.Int8(request.settled_seq);
    rejects_max = std::max(rejects_max, request.rejects_max);
    evict_ruri.Text(name);
    held_ruri.Text(name);
    held_session.Uuid(request.session);
    for (const model::SessionId& held : request.sessions_held) {
      if (held == request.session) continue;
      held_ruri.Text(name);
      held_session.Uuid(held);
    }
  }
  std::vector<StoreCall> calls;
  calls.push_back(StoreCallOf(kOpenRobots, {&ruri, &fleet, &at}));
  calls.back().parameters.Uuid(model::SessionId(process));
  calls.back().parameters.Add(std::move(ended));
  calls.push_back(StoreCallOf(kNumberNewRobots, {&new_ruri}));
  calls.push_back({kNextBatch, {}});
  calls.push_back(StoreCallOf(kOpenSessions, {&session_ruri, &session, &used}));
  calls.back().parameters.Uuid(model::SessionId(process));
  calls.back().parameters.Add(std::move(told));
  calls.push_back(StoreCallOf(kReadRejects, {&settled_ruri, &settled_session, &settled}));
  calls.back().parameters.Int8(static_cast<std::int64_t>(rejects_max));
  calls.push_back(StoreCallOf(kCountRejects, {&counted_ruri, &counted_session, &counted}));
  calls.back().parameters.Int8(static_cast<std::int64_t>(kQuarantineRowsPerRobotMax));
  calls.push_back(StoreCallOf(kEvictSessions, {&evict_ruri, &held_ruri, &held_session}));
  calls.back().parameters.Int8(static_cast<std::int64_t>(kSessionsPerRobotMax));
  calls.back().parameters.Uuid(model::SessionId(process));
  calls.push_back(ReadPresenceCall(ruris));
  calls.push_back(StoreCallOf(kReadLatestKinds, {&latest_ruri}));
  return calls;
}

/// `answers` are those of CallsOf, from the first on.
void Take(const Wave& wave, std::span<const OpenRequest> requests, std::span<const Result> answers,
          std::vector<OpenResult>& results) {
  const auto result_of = [&](const Result& rows, int row) -> OpenResult& {
    const auto found = wave.find(rows.Bytes(row, 0));
    UPLINK_CHECK(found != wave.end(), "an answer of a robot that was not asked for");
    return results[found->second];
  };
  for (const auto& [name, index] : wave) results[index].taken = false;
  const Result& robots = answers[0];
  for (int row = 0; row < robots.rows(); ++row) {
    OpenResult& result = result_of(robots, row);
    result.taken = true;
    result.epoch = static_cast<Epoch>(robots.Int(row, 1));
    result.held_since = static_cast<Epoch>(robots.Int(row, 2));
    result.was_known = result.epoch != 0;
  }
  const Result& numbered = answers[1];
  for (int row = 0; row < numbered.rows(); ++row) {
    OpenResult& result = result_of(numbered, row);
    result.epoch = result.held_since = static_cast<Epoch>(numbered.Int(row, 1));
  }
  const Result& sessions = answers[3];
  for (int row = 0; row < sessions.rows(); ++row) {
    result_of(sessions, row).cursor = static_cast<model::Seq>(sessions.Int(row, 1));
  }
  TakePresence(answers[7], [&](std::string_view name, StoredPresence presence) {
    OpenResult& result = results[wave.find(name)->second];
    if (result.taken) result.presence = presence;
  });
  const Result& rejects = answers[4];
  for (int row = 0; row < rejects.rows(); ++row) {
    const std::size_t index = wave.find(rejects.Bytes(row, 0))->second;
    if (results[index].rejects.size() == requests[index].rejects_max) continue;
    results[index].rejects.push_back(
        {static_cast<model::Seq>(rejects.Int(row, 1)), ReadRejection(rejects, row, 2)});
  }
  const Result& latest = answers[8];
  for (int row = 0; row < latest.rows(); ++row) {
    OpenResult& result = result_of(latest, row);
    if (result.taken) result.latest_kinds |= BitOf(static_cast<LatestKind>(latest.Int(row, 1)));
  }
  const Result& counts = answers[5];
  for (int row = 0; row < counts.rows(); ++row) {
    result_of(counts, row).rejects_total = static_cast<std::size_t>(counts.Int(row, 1));
  }
}

}  // namespace

absl::StatusOr<std::vector<OpenResult>> OpenAll(
    Connection& connection, std::span<const OpenRequest> requests, const ProcessId& process,
    const std::function<absl::Status()>& before_commit) {
  std::vector<OpenResult> results(requests.size());
  const std::vector<Wave> waves = WavesOf(requests);
  std::vector<StoreCall> calls = BeginCalls();
  std::vector<std::size_t> firsts;
  for (const Wave& wave : waves) {
    firsts.push_back(calls.size());
    std::ranges::move(CallsOf(wave, requests, process), std::back_inserter(calls));
  }
  const auto answers = RunAndCommitFor(connection, std::move(calls), kDoing, before_commit);
  if (!answers.ok()) return Decisive(answers.status());
  for (std::size_t i = 0; i < waves.size(); ++i) {
    Take(waves[i], requests, std::span(*answers).subspan(firsts[i]), results);
  }
  return results;
}

}  // namespace uplink::storage::postgres
