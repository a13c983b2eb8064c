#include "storage/postgres/write/known.h"

#include <algorithm>
#include <set>

#include "storage/bounds.h"
#include "storage/expiry.h"
#include "storage/postgres/tables/present_sql.h"
#include "storage/postgres/write/known_drones.h"
#include "storage/postgres/write/reads.h"
#include "storage/postgres/write/transaction.h"
#include "storage/read_row.h"

namespace uplink::storage::postgres {
namespace {

// These leases stay ours until the transaction ends; commits do not wait for each other.
constexpr std::string_view kLockLeases =
    "SELECT client_id, epoch, process = $2::uuid FROM uplinkd.topic_clients"
    " WHERE client_id = ANY($1::text[]) ORDER BY client_id FOR SHARE";
// A batch makes no robot: one that has no row has no holder.
constexpr std::string_view kLockRobots =
    "SELECT ruri, held_since, owner = $2::uuid FROM uplinkd.robots WHERE ruri = ANY($1::text[])"
    " ORDER BY ruri FOR NO KEY UPDATE";
// The server's own sessions have no robot. A session's row is looked for from the greatest part
// down (see the migration of session parts).
constexpr std::string_view kInsertSessions =
    "INSERT INTO uplinkd.sessions (ruri, session, cursor_seq, last_used, first_entry)"
    " SELECT u.ruri, u.session, 0, u.used, (SELECT currval('uplinkd.batches') << 20)"
    " FROM unnest($1::text[], $2::uuid[], $3::bigint[], $4::timestamptz[])"
    " AS u (ruri, session, held, used) LEFT JOIN uplinkd.robots AS r ON r.ruri = u.ruri"
    " LEFT JOIN LATERAL (SELECT l.part FROM uplinkd.sessions AS l"
    " WHERE l.ruri = u.ruri AND l.session = u.session ORDER BY l.part DESC LIMIT 1) AS s ON true"
    " WHERE s.part IS NULL AND (u.ruri = 'server' OR (u.held = r.held_since AND r.owner = "
    "$5::uuid))"
    " ON CONFLICT (ruri, session, part) DO NOTHING";
constexpr std::string_view kReadSessions =
    "SELECT s.ruri, s.session, s.cursor_seq"
    " FROM unnest($1::text[], $2::uuid[]) AS u (ruri, session) CROSS JOIN LATERAL"
    " (SELECT l.ruri, l.session, l.cursor_seq FROM uplinkd.sessions AS l"
    " WHERE l.ruri = u.ruri AND l.session = u.session ORDER BY l.part DESC LIMIT 1"
    " FOR NO KEY UPDATE) AS s";
// All but $1 and the $2 that were used last go.
constexpr std::string_view kTrimProcesses =
    "DELETE FROM uplinkd.sessions AS s USING (SELECT session, part FROM uplinkd.sessions"
    " WHERE ruri = 'server' AND session <> $1::uuid"
    " ORDER BY last_used DESC, session DESC OFFSET $2::bigint) AS old"
    " WHERE s.ruri = 'server' AND s.session = old.session AND s.part = old.part";
constexpr std::string_view kReadRejected =
    "SELECT u.place, q.reason, q.field, q.detail"
    " FROM unnest($1::text[], $2::uuid[], $3::bigint[], $4::int[]) AS u (ruri, session, seq, place)"
    " CROSS JOIN LATERAL (SELECT l.cursor_seq, l.first_entry FROM uplinkd.sessions AS l"
    " WHERE l.ruri = u.ruri AND l.session = u.session ORDER BY l.part DESC LIMIT 1) AS s"
    " CROSS JOIN LATERAL (SELECT q.reason, q.field, q.detail FROM uplinkd.quarantine AS q"
    " WHERE q.ruri = u.ruri AND q.session = u.session AND q.seq = u.seq"
    " AND q.entry >= s.first_entry"
    // Ranges do not overlap: the first that ends at the number or above is the one that may hold
    // it.
    " UNION ALL SELECT k.reason, k.field, k.detail FROM (SELECT l.first, l.reason, l.field,"
    " l.detail FROM uplinkd.kept_rejects AS l WHERE l.ruri = u.ruri AND l.session = u.session"
    " AND l.last >= u.seq AND l.entry >= s.first_entry ORDER BY l.last LIMIT 1) AS k"
    " WHERE k.first <= u.seq) AS q WHERE u.seq <= s.cursor_seq";

/// Before robots are locked, as hold_topics goes before begin_batch.
void ReadLeases(const Slice& slice, const ProcessId& process, KnownRows& known, Reads& reads) {
  std::set<std::string_view> clients;
  const auto add = [&clients](const TopicHold* hold) {
    if (hold != nullptr) clients.insert(hold->client_id);
  };
  for (const CommitRecord& record : slice.records()) add(HoldOf(record.origin));
  if (slice.with_rest) {
    for (const CommitRecord& record : slice.batch->records) {
      if (record.message_end) add(HoldOf(record.origin));
    }
    for (const Deliveries& deliveries : slice.batch->deliveries) {
      add(deliveries.hold.get());
    }
  }
  if (clients.empty()) return;
  Array locked{Type::kText};
  for (const std::string_view client : clients) locked.Text(client);
  reads.Add(StoreCallOf(kLockLeases, &locked, process), [&known](const Result& rows) {
    for (const ResultRow& row : rows) {
      if (!row.Bool(2)) continue;
      known.leases[TextIn(row, 0)] = static_cast<Epoch>(row.Int(1));
    }
  });
}

void ReadRobots(const Slice& slice, const ProcessId& process, KnownRows& known, Reads& reads) {
  std::set<std::string_view> robots;
  for (const CommitRecord& record : slice.records()) robots.insert(record.robot->ruri);
  if (slice.with_rest) {
    for (const GapItem& gap : slice.batch->gaps) robots.insert(gap.robot->ruri);
    for (const PresenceItem& item : slice.batch->presence) robots.insert(item.robot->ruri);
  }
  Array locked{Type::kText};
  for (const std::string_view ruri : robots) locked.Text(ruri);
  reads.Add(StoreCallOf(kLockRobots, &locked, process), [&known](const Result& rows) {
    for (const ResultRow& row : rows) {
      KnownRobot& robot = known.robots[TextIn(row, 0)];
      if (row.Bool(2)) robot.held_since = NumberIn(row, 1);
    }
  });
  reads.Add({kNextBatch, {}});
}

void ReadSessions(const Slice& slice, const ProcessId& process, KnownRows& known, Reads& reads) {
  struct Use {
    /// Records of one session may come under several holds; at most one of them is valid.
    std::set<Epoch> holds;
    SystemTime used;
  };
  std::map<std::pair<std::string_view, model::SessionId>, Use> sessions;
  for (const CommitRecord& record : slice.records()) {
    if (record.seq == 0 || record.sample != nullptr) continue;
    Use& use = sessions[{record.robot->ruri, record.session}];
    use.holds.insert(record.held_since);
    use.used = std::max(use.used, record.received_at);
  }
  const Batch& batch = *slice.batch;
  const bool presence = slice.with_rest && !batch.presence.empty();
  if (presence) {
    sessions[{kServerRuri, batch.presence_session}] = {{Epoch{0}}, batch.presence.back().at};
  }

  Array ruri{Type::kText}, session{Type::kUuid}, held{Type::kInt8}, used{Type::kTime};
  Array read_ruri{Type::kText}, read_session{Type::kUuid};
  for (const auto& [key, use] : sessions) {
    for (const Epoch hold : use.holds) {
      ruri.Text(key.first);
      session.Uuid(key.second);
      held.Int8(hold);
      used.Time(use.used);
    }
    read_ruri.Text(key.first);
    read_session.Uuid(key.second);
  }
  reads.Add(StoreCallOf(kInsertSessions, &ruri, &session, &held, &used, process));
  reads.Add(StoreCallOf(kReadSessions, &read_ruri, &read_session), [&known](const Result& rows) {
    for (const ResultRow& row : rows) {
      known.sessions[{TextIn(row, 0), row.Uuid(1)}].cursor = static_cast<model::Seq>(row.Int(2));
    }
  });
  if (!presence) return;
  reads.Add(StoreCallOf(kTrimProcesses, batch.presence_session, kServerSessionsMax - 1));
}

void ReadRejected(const Slice& slice, KnownRows& known, Reads& reads) {
  Array ruri{Type::kText}, session{Type::kUuid}, seq{Type::kInt8}, place{Type::kInt4};
  for (std::size_t i = slice.first; i < slice.last; ++i) {
    const CommitRecord& record = slice.batch->records[i];
    if (record.sample != nullptr) continue;
    ruri.Text(record.robot->ruri);
    session.Uuid(record.session);
    seq.Int8(record.seq);
    place.Int4(static_cast<std::int32_t>(i));
  }
  reads.Add(
      StoreCallOf(kReadRejected, &ruri, &session, &seq, &place),
      [&known, &batch = *slice.batch](const Result& rows) {
        for (const ResultRow& row : rows) {
          const CommitRecord& record = batch.records[static_cast<std::size_t>(row.Int(0))];
          known.rejected[{record.robot->ruri, record.session, record.seq}] = RejectionIn(row, 1);
        }
      });
}

/// The upserts of one robot in a slice.
struct Upserts {
  std::int32_t count = 0;
  /// By when an entry must have expired to give its place to one of them (ExpiredByMs).
  std::int64_t by_ms = 0;
};

/// The entries of one kind that a slice names.
struct Named {
  Array ruri{Type::kText}, id{Type::kText}, source{Type::kText};
  /// For each robot that has entries here.
  std::map<std::string_view, Upserts> upserts;
};

void ReadPresent(PresentKind kind, Named& named, KnownRows& known, Reads& reads) {
  if (named.upserts.empty()) return;
  Array counted{Type::kText}, near{Type::kText}, count{Type::kInt4}, by_ms{Type::kInt8};
  for (const auto& [robot, upserts] : named.upserts) {
    counted.Text(robot);
    near.Text(robot);
    count.Int4(upserts.count);
    by_ms.Int8(upserts.by_ms);
  }
  const auto index = static_cast<std::size_t>(kind);
  const PresentSql& sql = PresentSqlOf(kind);
  const auto take_entries = [&entries = known.present[index]](const Result& rows) {
    for (const ResultRow& row : rows) {
      entries[{TextIn(row, 0), TextIn(row, 1), TextIn(row, 2)}] = row.Int(3);
    }
  };
  StoreCall read = StoreCallOf(sql.read.view(), &named.ruri, &named.id);
  if (sql.has_source) read.parameters.Add(&named.source);
  reads.Add(std::move(read), take_entries);
  reads.Add(StoreCallOf(sql.count.view(), &counted), [&known, index](const Result& rows) {
    for (const ResultRow& row : rows) {
      const auto robot = known.robots.find(row.Bytes(0));
      // Rows of one that has none itself.
      if (robot == known.robots.end()) continue;
      robot->second.counts[index] = static_cast<std::size_t>(row.Int(1));
    }
  });
  const PresentBound& bound = BoundOf(kind);
  if (!bound.expires) return;
  reads.Add(StoreCallOf(sql.expired.view(), &near, &count, &by_ms, bound.entries_max),
            take_entries);
}

void ReadAllPresent(const Slice& slice, const StoreRules& rules, KnownRows& known, Reads& reads) {
  std::array<Named, kPresentKinds> kinds;
  for (const CommitRecord& record : slice.records()) {
    const std::optional<PresentChange> change = PresentChangeOf(record, rules);
    if (!change) continue;
    Named& named = kinds[static_cast<std::size_t>(change->key.kind)];
    named.ruri.Text(change->key.ruri);
    named.id.Text(change->key.id);
    named.source.Text(change->key.source);
    Upserts& upserts = named.upserts[change->key.ruri];
    if (!change->is_upsert) continue;
    ++upserts.count;
    upserts.by_ms = std::max(upserts.by_ms, ExpiredByMs(record.received_at, rules));
  }
  for (const PresentKind kind : {PresentKind::kFault, PresentKind::kShape, PresentKind::kObject}) {
    ReadPresent(kind, kinds[static_cast<std::size_t>(kind)], known, reads);
  }
}

}  // namespace

absl::StatusOr<KnownRows> ReadKnown(Connection& connection, const Slice& slice,
                                    const CommitTerms& terms) {
  KnownRows known;
  Reads reads;
  ReadLeases(slice, terms.process, known, reads);
  ReadRobots(slice, terms.process, known, reads);
  ReadDrones(slice, terms.process, known, reads);
  ReadSessions(slice, terms.process, known, reads);
  ReadRejected(slice, known, reads);
  ReadAllPresent(slice, terms.rules, known, reads);
  absl::Status read = reads.Run(connection);
  if (!read.ok()) return read;
  return known;
}

}  // namespace uplink::storage::postgres
