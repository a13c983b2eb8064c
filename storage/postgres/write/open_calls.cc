#include "storage/postgres/write/open_calls.h"

#include <algorithm>
#include <utility>

#include "storage/bounds.h"
#include "storage/postgres/tables/rejects_sql.h"
#include "storage/postgres/write/holds.h"
#include "storage/postgres/write/transaction.h"
#include "storage/sql_text.h"

namespace uplink::storage::postgres {
namespace {

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
    // A stream that has ended ($5) takes its robot only from a process that released its lease.
    " WHERE NOT (r.ruri = ANY ($5::text[]) AND r.owner <> excluded.owner AND EXISTS (SELECT 1"
    " FROM uplinkd.processes AS p WHERE p.process = r.owner AND NOT p.released))"
    // A word that moves nothing ($6) stands for no robot of another fleet.
    " AND NOT (r.ruri = ANY ($6::text[]) AND r.fleet <> excluded.fleet)"
    // The row as it was: only a fleet that another server changes in this very moment is missed.
    " RETURNING ruri, epoch, held_since,"
    " (SELECT o.fleet FROM uplinkd.robots AS o WHERE o.ruri = r.ruri)";
// The robots' rows are locked by then, those that were not taken too. A robot that was taken is of
// its request's fleet.
constexpr std::string_view kReadFleets =
    "SELECT ruri, fleet FROM uplinkd.robots WHERE ruri = ANY ($1::text[])";
constexpr std::string_view kNumberNewRobots =
    "UPDATE uplinkd.robots AS r SET (epoch, held_since) = (SELECT d.epoch, d.epoch"
    " FROM (SELECT greatest(nextval('uplinkd.epochs'), r.epoch + 1) AS epoch) AS d)"
    " WHERE r.ruri = ANY ($1::text[]) AND r.epoch = 0 RETURNING r.ruri, r.epoch";
// A session's row is looked for from the greatest part down (see the migration of session parts).
// The robots' rows are locked by then, so no one adds the same session meanwhile.
constexpr std::string_view kOpenSessions =
    "WITH u AS (SELECT * FROM unnest($1::text[], $2::uuid[], $3::timestamptz[], $5::bigint[],"
    " $6::text[]) AS u (ruri, session, used, settled, fleet)"
    " WHERE EXISTS (SELECT 1 FROM uplinkd.robots AS r"
    " WHERE r.ruri = u.ruri AND r.owner = $4::uuid AND r.fleet = u.fleet)),"
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
constexpr SqlText kReadRejects = {
    "SELECT u.ruri, q.seq, q.reason, q.field, q.detail"
    " FROM unnest($1::text[], $2::uuid[], $3::bigint[]) AS u (ruri, session, above)"
    " CROSS JOIN LATERAL (SELECT l.cursor_seq AS through, l.first_entry FROM uplinkd.sessions AS l"
    " WHERE l.ruri = u.ruri AND l.session = u.session ORDER BY l.part DESC LIMIT 1) AS s",
    kJoinRejects, " ORDER BY u.ruri, q.seq"};
// The same, of quarantine by its primary key without the table.
constexpr std::string_view kCountRejects =
    "SELECT u.ruri, least($4::bigint, q.total + k.total)"
    " FROM unnest($1::text[], $2::uuid[], $3::bigint[]) AS u (ruri, session, settled)"
    " CROSS JOIN LATERAL (SELECT l.cursor_seq, l.first_entry FROM uplinkd.sessions AS l"
    " WHERE l.ruri = u.ruri AND l.session = u.session ORDER BY l.part DESC LIMIT 1) AS s"
    " CROSS JOIN LATERAL (SELECT count(*) AS total FROM (SELECT FROM uplinkd.quarantine AS p"
    " WHERE p.ruri = u.ruri AND p.session = u.session AND p.seq > u.settled"
    " AND p.seq <= s.cursor_seq AND p.entry >= s.first_entry ORDER BY p.seq LIMIT $4::bigint) AS "
    "rows) AS q"
    " CROSS JOIN LATERAL (SELECT coalesce(sum(rows.numbers), 0)::bigint AS total FROM"
    " (SELECT p.last - greatest(p.first, u.settled + 1) + 1 AS numbers"
    " FROM uplinkd.kept_rejects AS p"
    " WHERE p.ruri = u.ruri AND p.session = u.session AND p.last > u.settled"
    " AND p.last <= s.cursor_seq AND p.entry >= s.first_entry"
    " ORDER BY p.last LIMIT $4::bigint) AS rows) AS k";
// Of each robot, the least recently used sessions over the bound that no stream holds. From one
// session to the next by its key, so that dead versions of their rows are passed over. The Rejects
// that are kept of a session go with it.
constexpr std::string_view kEvictSessions =
    "WITH RECURSIVE p AS (SELECT n.* FROM unnest($1::text[], $6::text[]) AS u (ruri, fleet)"
    " JOIN uplinkd.robots AS r ON r.ruri = u.ruri AND r.owner = $5::uuid AND r.fleet = u.fleet"
    " CROSS JOIN LATERAL"
    " (SELECT l.ruri, l.session, l.part, l.last_used FROM uplinkd.sessions AS l"
    " WHERE l.ruri = u.ruri ORDER BY l.session DESC, l.part DESC LIMIT 1) AS n"
    " UNION ALL SELECT n.* FROM p CROSS JOIN LATERAL"
    " (SELECT l.ruri, l.session, l.part, l.last_used FROM uplinkd.sessions AS l"
    " WHERE l.ruri = p.ruri AND l.session < p.session"
    " ORDER BY l.session DESC, l.part DESC LIMIT 1) AS n)"
    ", went AS (DELETE FROM uplinkd.sessions AS s USING ("
    "SELECT a.ruri, a.session, a.part, a.kept, row_number() OVER (PARTITION BY a.ruri"
    " ORDER BY a.last_used, a.session) AS place FROM (SELECT p.ruri, p.session, p.part,"
    " p.last_used,"
    " count(*) OVER (PARTITION BY p.ruri) AS kept FROM p) AS a WHERE a.kept > $4::bigint"
    " AND NOT EXISTS (SELECT 1 FROM unnest($2::text[], $3::uuid[]) AS held (ruri, session)"
    " WHERE held.ruri = a.ruri AND held.session = a.session)) AS old"
    " WHERE s.ruri = old.ruri AND s.session = old.session AND s.part = old.part"
    " AND old.place <= old.kept - $4::bigint RETURNING s.ruri, s.session)"
    " DELETE FROM uplinkd.kept_rejects WHERE ctid = ANY (ARRAY(SELECT k.tid FROM went"
    " CROSS JOIN LATERAL (SELECT l.ctid AS tid FROM uplinkd.kept_rejects AS l"
    " WHERE l.ruri = went.ruri AND l.session = went.session ORDER BY l.last) AS k))";
// What a Hello confirmed. A session without a number yet is new: what is kept by its id is of one
// that went. The rows are looked for by the key, session by session: that they are ordered keeps
// the planner from another way.
constexpr std::string_view kForgetKept =
    "DELETE FROM uplinkd.kept_rejects WHERE ctid = ANY (ARRAY(SELECT k.tid"
    " FROM unnest($1::text[], $2::uuid[]) AS u (ruri, session)"
    " CROSS JOIN LATERAL (SELECT CASE WHEN l.cursor_seq = 0 THEN 9223372036854775807"
    " ELSE l.settled_seq END AS through FROM uplinkd.sessions AS l"
    " WHERE l.ruri = u.ruri AND l.session = u.session ORDER BY l.part DESC LIMIT 1) AS s"
    " CROSS JOIN LATERAL (SELECT l.ctid AS tid FROM uplinkd.kept_rejects AS l"
    " WHERE l.ruri = u.ruri AND l.session = u.session AND l.last <= s.through"
    " ORDER BY l.last) AS k))";

// The primary key tells it without the table.
constexpr std::string_view kReadLatestKinds =
    "SELECT ruri, kind FROM uplinkd.latest WHERE ruri = ANY ($1::text[])";

/// The columns of a wave's requests, each made anew for each statement, since a statement takes its
/// parameters along.
class Columns final {
 public:
  Columns(const Wave& wave, std::span<const OpenRequest> requests)
      : wave_(wave), requests_(requests) {}

  [[nodiscard]] Array Ruris() const {
    return Of(Type::kText,
              [](Array& column, const OpenRequest& request) { column.Text(request.robot->ruri); });
  }
  [[nodiscard]] Array Fleets() const {
    return Of(Type::kText,
              [](Array& column, const OpenRequest& request) { column.Text(request.robot->fleet); });
  }
  [[nodiscard]] Array Sessions() const {
    return Of(Type::kUuid,
              [](Array& column, const OpenRequest& request) { column.Uuid(request.session); });
  }
  [[nodiscard]] Array Times() const {
    return Of(Type::kTime,
              [](Array& column, const OpenRequest& request) { column.Time(request.at); });
  }
  [[nodiscard]] Array Settled() const {
    return Of(Type::kInt8,
              [](Array& column, const OpenRequest& request) { column.Int8(request.settled_seq); });
  }
  /// RURIs of streams that have ended.
  [[nodiscard]] Array Ended() const {
    return Of(Type::kText, [](Array& column, const OpenRequest& request) {
      if (request.stream == StreamState::kEnded) column.Text(request.robot->ruri);
    });
  }
  /// RURIs of streams whose word moves nothing.
  [[nodiscard]] Array Matched() const {
    return Of(Type::kText, [](Array& column, const OpenRequest& request) {
      if (request.fleet_word == FleetWord::kMatches) column.Text(request.robot->ruri);
    });
  }

 private:
  template <typename Add>
  Array Of(Type type, const Add& add) const {
    Array column{type};
    for (const auto& [name, index] : wave_) add(column, requests_[index]);
    return column;
  }

  const Wave& wave_;
  std::span<const OpenRequest> requests_;
};

StoreCall EvictCall(const Wave& wave, std::span<const OpenRequest> requests,
                    const ProcessId& process) {
  const Columns columns(wave, requests);
  Array held_ruri{Type::kText}, held_session{Type::kUuid};
  for (const auto& [name, index] : wave) {
    const OpenRequest& request = requests[index];
    held_ruri.Text(name);
    held_session.Uuid(request.session);
    for (const model::SessionId& held : request.sessions_held) {
      if (held == request.session) continue;
      held_ruri.Text(name);
      held_session.Uuid(held);
    }
  }
  return StoreCallOf(kEvictSessions, columns.Ruris(), &held_ruri, &held_session,
                     kSessionsPerRobotMax, process, columns.Fleets());
}

/// Of a statement over the numbers above what is settled, up to so many of each robot.
StoreCall RejectsCall(std::string_view sql, const Columns& columns, std::size_t most) {
  return StoreCallOf(sql, columns.Ruris(), columns.Sessions(), columns.Settled(), most);
}

}  // namespace

std::vector<StoreCall> CallsOf(const Wave& wave, std::span<const OpenRequest> requests,
                               const ProcessId& process) {
  const Columns columns(wave, requests);
  std::size_t rejects_max = 0;
  std::vector<std::string_view> ruris;
  for (const auto& [name, index] : wave) {
    ruris.push_back(name);
    rejects_max = std::max(rejects_max, requests[index].rejects_max);
  }
  return PipelineOf(StoreCallOf(kOpenRobots, columns.Ruris(), columns.Fleets(), columns.Times(),
                                process, columns.Ended(), columns.Matched()),
                    StoreCallOf(kNumberNewRobots, columns.Ruris()), StoreCallOf(kNextBatch),
                    StoreCallOf(kOpenSessions, columns.Ruris(), columns.Sessions(), columns.Times(),
                                process, columns.Settled(), columns.Fleets()),
                    RejectsCall(kReadRejects.view(), columns, rejects_max),
                    RejectsCall(kCountRejects, columns, kQuarantineRowsPerRobotMax),
                    EvictCall(wave, requests, process),
                    StoreCallOf(kForgetKept, columns.Ruris(), columns.Sessions()),
                    ReadPresenceCall(ruris), StoreCallOf(kReadLatestKinds, columns.Ruris()),
                    StoreCallOf(kReadFleets, columns.Matched()));
}

}  // namespace uplink::storage::postgres
