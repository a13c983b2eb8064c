#include "storage/postgres/known.h"

#include <algorithm>
#include <functional>
#include <string_view>
#include <variant>

#include "storage/postgres/rejection_row.h"
#include "storage/postgres/transaction.h"

namespace uplink::storage::postgres {
namespace {

constexpr std::string_view kInsertRobots =
    "INSERT INTO uplinkd.robots (ruri, fleet, epoch, held_since, owner, first_seen, last_seen)"
    " SELECT ruri, fleet, held, held, $5::uuid, seen_at, seen_at"
    " FROM unnest($1::text[], $2::text[], $3::bigint[], $4::timestamptz[])"
    " AS u (ruri, fleet, held, seen_at) ON CONFLICT (ruri) DO NOTHING";
constexpr std::string_view kLockRobots =
    "SELECT ruri, held_since FROM uplinkd.robots WHERE ruri = ANY($1::text[])"
    " ORDER BY ruri FOR NO KEY UPDATE";
// The server's own sessions have no robot.
constexpr std::string_view kInsertSessions =
    "INSERT INTO uplinkd.sessions (ruri, session, cursor_seq, last_used, first_entry)"
    " SELECT u.ruri, u.session, 0, u.used, (SELECT currval('uplinkd.batches') << 20)"
    " FROM unnest($1::text[], $2::uuid[], $3::bigint[], $4::timestamptz[])"
    " AS u (ruri, session, held, used) LEFT JOIN uplinkd.robots AS r ON r.ruri = u.ruri"
    " WHERE r.ruri IS NULL OR u.held >= r.held_since ON CONFLICT (ruri, session) DO NOTHING";
constexpr std::string_view kReadSessions =
    "SELECT s.ruri, s.session, s.cursor_seq"
    " FROM unnest($1::text[], $2::uuid[]) AS u (ruri, session)"
    " JOIN uplinkd.sessions AS s ON s.ruri = u.ruri AND s.session = u.session"
    " ORDER BY s.ruri, s.session FOR NO KEY UPDATE OF s";
// All but $1 and the $2 that were used last go.
constexpr std::string_view kTrimProcesses =
    "DELETE FROM uplinkd.sessions AS s USING (SELECT session FROM uplinkd.sessions"
    " WHERE ruri = 'server' AND session <> $1::uuid"
    " ORDER BY last_used DESC, session DESC OFFSET $2::bigint) AS old"
    " WHERE s.ruri = 'server' AND s.session = old.session";
constexpr std::string_view kReadQuarantined =
    "SELECT u.place, q.reason, q.field, q.detail"
    " FROM unnest($1::text[], $2::uuid[], $3::bigint[], $4::int[]) AS u (ruri, session, seq, place)"
    " JOIN uplinkd.sessions AS s ON s.ruri = u.ruri AND s.session = u.session"
    " JOIN uplinkd.quarantine AS q ON q.ruri = u.ruri AND q.session = u.session AND q.seq = u.seq"
    " AND q.entry >= s.first_entry WHERE u.seq <= s.cursor_seq";
constexpr std::string_view kReadActive =
    "SELECT f.ruri, f.fault_id, f.source"
    " FROM unnest($1::text[], $2::text[], $3::text[]) AS u (ruri, fault_id, source)"
    " JOIN uplinkd.faults_active AS f ON f.ruri = u.ruri AND f.fault_id = u.fault_id"
    " AND f.source = u.source";
constexpr std::string_view kCountActive =
    "SELECT u.ruri, (SELECT count(*) FROM uplinkd.faults_active AS f WHERE f.ruri = u.ruri)"
    " FROM unnest($1::text[]) AS u (ruri)";

/// The statements for one of the tables of what is present.
struct PresentSql {
  std::string_view read;
  std::string_view count;
  /// $2: upserts a robot, $3: the bound.
  std::string_view expiring;
};
constexpr PresentSql kShapeSql = {
    "SELECT s.ruri, s.id, s.expires_ms FROM unnest($1::text[], $2::text[]) AS u (ruri, id)"
    " JOIN uplinkd.shapes AS s ON s.ruri = u.ruri AND s.id = u.id",
    "SELECT u.ruri, (SELECT count(*) FROM uplinkd.shapes AS s WHERE s.ruri = u.ruri)"
    " FROM unnest($1::text[]) AS u (ruri)",
    "SELECT s.ruri, s.id, s.expires_ms FROM unnest($1::text[], $2::int[]) AS u (ruri, upserts)"
    " JOIN uplinkd.shapes AS s ON s.ruri = u.ruri AND s.expires_ms <> 0"
    " WHERE u.upserts + (SELECT count(*) FROM uplinkd.shapes AS c WHERE c.ruri = u.ruri)"
    " > $3::bigint"};
constexpr PresentSql kObjectSql = {
    "SELECT s.ruri, s.id, s.expires_ms FROM unnest($1::text[], $2::text[]) AS u (ruri, id)"
    " JOIN uplinkd.objects AS s ON s.ruri = u.ruri AND s.id = u.id",
    "SELECT u.ruri, (SELECT count(*) FROM uplinkd.objects AS s WHERE s.ruri = u.ruri)"
    " FROM unnest($1::text[]) AS u (ruri)",
    "SELECT s.ruri, s.id, s.expires_ms FROM unnest($1::text[], $2::int[]) AS u (ruri, upserts)"
    " JOIN uplinkd.objects AS s ON s.ruri = u.ruri AND s.expires_ms <> 0"
    " WHERE u.upserts + (SELECT count(*) FROM uplinkd.objects AS c WHERE c.ruri = u.ruri)"
    " > $3::bigint"};

std::string Text(const Result& result, int row, int column) {
  return std::string(result.Bytes(row, column));
}

/// One call of a pipeline and what becomes of its answer.
class Reads final {
 public:
  using Take = std::function<void(const Result&)>;
  void Add(
      Call call, Take take = [](const Result&) {}) {
    calls_.push_back(std::move(call));
    takes_.push_back(std::move(take));
  }
  absl::Status Run(Connection& connection) {
    const absl::StatusOr<std::vector<Result>> results =
        connection.Run(calls_, "read what a batch touches");
    if (!results.ok()) return results.status();
    for (std::size_t i = 0; i < takes_.size(); ++i) takes_[i]((*results)[i]);
    return absl::OkStatus();
  }

 private:
  std::vector<Call> calls_;
  std::vector<Take> takes_;
};

void ReadRobots(const Part& part, const ProcessId& process, Known& known, Reads& reads) {
  struct First {
    const RobotRef* robot;
    Epoch held_since;
    SystemTime at;
  };
  std::map<std::string_view, First> robots;
  for (const CommitRecord& record : part.records()) {
    robots.try_emplace(record.robot->ruri,
                       First{&record.robot, record.held_since, record.received_at});
  }
  if (part.with_rest) {
    for (const GapItem& gap : part.batch->gaps) {
      robots.try_emplace(gap.robot->ruri, First{&gap.robot, gap.held_since, gap.seen_at});
    }
  }
  Array ruri{Type::kText}, fleet{Type::kText}, held{Type::kInt8}, at{Type::kTime};
  Array locked{Type::kText};
  for (const auto& [name, first] : robots) {
    ruri.Text(name);
    fleet.Text((*first.robot)->fleet);
    held.Int8(first.held_since);
    at.Time(first.at);
    locked.Text(name);
  }
  Call insert = CallOf(kInsertRobots, {&ruri, &fleet, &held, &at});
  insert.parameters.Uuid(model::SessionId(process));
  reads.Add(std::move(insert));
  reads.Add(CallOf(kLockRobots, {&locked}), [&known](const Result& rows) {
    for (int row = 0; row < rows.rows(); ++row) {
      known.held_since[Text(rows, row, 0)] = static_cast<Epoch>(rows.Int(row, 1));
    }
  });
  reads.Add({kNextBatch, {}});
}

void ReadSessions(const Part& part, Known& known, Reads& reads) {
  struct Use {
    Epoch held_since = 0;
    SystemTime used;
  };
  std::map<std::pair<std::string_view, model::SessionId>, Use> sessions;
  for (const CommitRecord& record : part.records()) {
    if (record.seq == 0) continue;
    Use& use = sessions[{record.robot->ruri, record.session}];
    use.held_since = std::max(use.held_since, record.held_since);
    use.used = std::max(use.used, record.received_at);
  }
  const Batch& batch = *part.batch;
  const bool presence = part.with_rest && !batch.presence.empty();
  if (presence) sessions[{kServerRuri, batch.presence_session}].used = batch.presence.back().at;

  Array ruri{Type::kText}, session{Type::kUuid}, held{Type::kInt8}, used{Type::kTime};
  Array read_ruri{Type::kText}, read_session{Type::kUuid};
  for (const auto& [key, use] : sessions) {
    ruri.Text(key.first);
    session.Uuid(key.second);
    held.Int8(use.held_since);
    used.Time(use.used);
    read_ruri.Text(key.first);
    read_session.Uuid(key.second);
  }
  reads.Add(CallOf(kInsertSessions, {&ruri, &session, &held, &used}));
  reads.Add(CallOf(kReadSessions, {&read_ruri, &read_session}), [&known](const Result& rows) {
    for (int row = 0; row < rows.rows(); ++row) {
      known.sessions[{Text(rows, row, 0), rows.Uuid(row, 1)}].cursor =
          static_cast<model::Seq>(rows.Int(row, 2));
    }
  });
  if (!presence) return;
  Call trim{kTrimProcesses, {}};
  trim.parameters.Uuid(batch.presence_session);
  trim.parameters.Int8(static_cast<std::int64_t>(kServerSessionsMax) - 1);
  reads.Add(std::move(trim));
}

void ReadQuarantined(const Part& part, Known& known, Reads& reads) {
  Array ruri{Type::kText}, session{Type::kUuid}, seq{Type::kInt8}, place{Type::kInt4};
  for (std::size_t i = part.first; i < part.last; ++i) {
    const CommitRecord& record = part.batch->records[i];
    ruri.Text(record.robot->ruri);
    session.Uuid(record.session);
    seq.Int8(record.seq);
    place.Int4(static_cast<std::int32_t>(i));
  }
  reads.Add(CallOf(kReadQuarantined, {&ruri, &session, &seq, &place}),
            [&known](const Result& rows) {
              for (int row = 0; row < rows.rows(); ++row) {
                known.quarantined[static_cast<std::size_t>(rows.Int(row, 0))] =
                    ReadRejection(rows, row, 1);
              }
            });
}

const model::Body* BodyOf(const CommitRecord& record) {
  const auto* good = std::get_if<model::Record>(&record.content);
  return good == nullptr ? nullptr : &good->body();
}

void ReadFaults(const Part& part, Known& known, Reads& reads) {
  Array ruri{Type::kText}, fault_id{Type::kText}, source{Type::kText}, counted{Type::kText};
  std::set<std::string_view> robots;
  for (const CommitRecord& record : part.records()) {
    const model::Body* body = BodyOf(record);
    const auto* fault = body == nullptr ? nullptr : std::get_if<model::Fault>(body);
    if (fault == nullptr) continue;
    ruri.Text(record.robot->ruri);
    fault_id.Text(fault->fault_id);
    source.Text(fault->source);
    if (robots.insert(record.robot->ruri).second) counted.Text(record.robot->ruri);
  }
  if (robots.empty()) return;
  reads.Add(CallOf(kReadActive, {&ruri, &fault_id, &source}), [&known](const Result& rows) {
    for (int row = 0; row < rows.rows(); ++row) {
      known.active.emplace(Text(rows, row, 0), Text(rows, row, 1), Text(rows, row, 2));
    }
  });
  reads.Add(CallOf(kCountActive, {&counted}), [&known](const Result& rows) {
    for (int row = 0; row < rows.rows(); ++row) {
      known.active_counts[Text(rows, row, 0)] = static_cast<std::size_t>(rows.Int(row, 1));
    }
  });
}

template <typename Op>
void ReadPresent(const Part& part, const PresentSql& sql, std::size_t rows_max, KnownPresent& known,
                 Reads& reads) {
  Array ruri{Type::kText}, id{Type::kText};
  std::map<std::string_view, std::int32_t> upserts;
  for (const CommitRecord& record : part.records()) {
    const model::Body* body = BodyOf(record);
    const auto* op = body == nullptr ? nullptr : std::get_if<Op>(body);
    if (op == nullptr) continue;
    ruri.Text(record.robot->ruri);
    id.Text(op->id());
    upserts[record.robot->ruri] += op->upsert() == nullptr ? 0 : 1;
  }
  if (upserts.empty()) return;
  Array counted{Type::kText}, near{Type::kText}, near_upserts{Type::kInt4};
  for (const auto& [robot, count] : upserts) {
    counted.Text(robot);
    near.Text(robot);
    near_upserts.Int4(count);
  }
  const auto take_expiry = [&known](const Result& rows) {
    for (int row = 0; row < rows.rows(); ++row) {
      known.expires_ms[{Text(rows, row, 0), Text(rows, row, 1)}] = rows.Int(row, 2);
    }
  };
  reads.Add(CallOf(sql.read, {&ruri, &id}), take_expiry);
  reads.Add(CallOf(sql.count, {&counted}), [&known](const Result& rows) {
    for (int row = 0; row < rows.rows(); ++row) {
      known.counts[Text(rows, row, 0)] = static_cast<std::size_t>(rows.Int(row, 1));
    }
  });
  Call expiring = CallOf(sql.expiring, {&near, &near_upserts});
  expiring.parameters.Int8(static_cast<std::int64_t>(rows_max));
  reads.Add(std::move(expiring), take_expiry);
}

}  // namespace

std::optional<model::Rejection> Known::Quarantined(const CommitRecord& record,
                                                   std::size_t place) const {
  const auto now = quarantined_now_.find({record.robot->ruri, record.session, record.seq});
  if (now != quarantined_now_.end()) return now->second;
  const auto before = quarantined.find(place);
  if (before == quarantined.end()) return std::nullopt;
  return before->second;
}

absl::StatusOr<Known> ReadKnown(Connection& connection, const Part& part,
                                const ProcessId& process) {
  Known known;
  Reads reads;
  ReadRobots(part, process, known, reads);
  ReadSessions(part, known, reads);
  ReadQuarantined(part, known, reads);
  ReadFaults(part, known, reads);
  ReadPresent<model::ShapeOp>(part, kShapeSql, kShapesPerRobotMax, known.shapes, reads);
  ReadPresent<model::ObjectOp>(part, kObjectSql, kObjectsPerRobotMax, known.objects, reads);
  absl::Status read = reads.Run(connection);
  if (!read.ok()) return read;
  return known;
}

}  // namespace uplink::storage::postgres
