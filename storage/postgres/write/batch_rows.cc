#include "storage/postgres/write/batch_rows.h"

#include <algorithm>
#include <optional>
#include <variant>

#include "schema/base/check.h"
#include "schema/json/text.h"
#include "storage/bounds.h"
#include "storage/postgres/write/upkeep.h"

namespace uplink::storage::postgres {
namespace {

// By the whole key of the row, which the subquery looks for from the greatest part down.
constexpr std::string_view kRaiseCursors =
    "UPDATE uplinkd.sessions AS s SET cursor_seq = greatest(s.cursor_seq, old.to_seq),"
    " last_used = greatest(s.last_used, old.used)"
    " FROM (SELECT p.ruri, p.session, p.part, u.to_seq, u.used"
    " FROM unnest($1::text[], $2::uuid[], $3::bigint[], $4::timestamptz[])"
    " AS u (ruri, session, to_seq, used) CROSS JOIN LATERAL (SELECT l.ruri, l.session, l.part"
    " FROM uplinkd.sessions AS l WHERE l.ruri = u.ruri AND l.session = u.session"
    " ORDER BY l.part DESC LIMIT 1) AS p) AS old"
    " WHERE s.ruri = old.ruri AND s.session = old.session AND s.part = old.part";

// The oldest payloads of each robot over its bound go; their rows stay.
constexpr std::string_view kThinPayloads =
    "UPDATE uplinkd.quarantine AS q SET payload = NULL"
    " FROM unnest($1::text[]) AS u (ruri) CROSS JOIN LATERAL"
    " (SELECT p.session, p.seq, p.entry, p.received_at FROM uplinkd.quarantine AS p"
    " WHERE p.ruri = u.ruri AND p.payload IS NOT NULL ORDER BY p.entry DESC OFFSET $2::bigint)"
    " AS old"
    " WHERE q.ruri = u.ruri AND q.session = old.session AND q.seq = old.seq"
    " AND q.entry = old.entry AND q.received_at = old.received_at";

constexpr std::string_view kTrimGaps =
    "DELETE FROM uplinkd.gaps AS g USING unnest($1::text[]) AS u (ruri) CROSS JOIN LATERAL"
    " (SELECT p.session, p.first FROM uplinkd.gaps AS p WHERE p.ruri = u.ruri"
    " ORDER BY p.seen_at DESC, p.entry DESC OFFSET $2::bigint) AS old"
    " WHERE g.ruri = u.ruri AND g.session = old.session AND g.first = old.first";

StoreCall BoundCall(std::string_view sql, const std::set<std::string_view>& robots,
                    std::size_t rows_max) {
  Array ruri{Type::kText};
  for (const std::string_view robot : robots) ruri.Text(robot);
  return StoreCallOf(sql, &ruri, rows_max);
}

}  // namespace

/// One overload per body that is more than a row of a history.
struct BatchRows::KindWriter {
  BatchRows& rows;
  const CommitRecord& record;
  const std::int32_t place;

  void operator()(const model::Fault& fault) const {
    rows.added_.Add<kFaultHistoryTable>({&record, &fault, place});
    Present(rows.faults_, fault.active ? &fault : nullptr);
  }
  void operator()(const model::MissionRunStatus& report) const {
    const std::string& text = rows.report_texts_.emplace_back(json::Text(report));
    const MissionReport row = {&record, &report, text, place};
    rows.added_.Add<kMissionReportsTable>(row);
    const auto [run, is_new] =
        rows.runs_.try_emplace({record.robot->ruri, report.mission_id, report.run_id}, row);
    if (!is_new) run->second.Add(row);
    if (!model::IsTerminal(report.status)) {
      SystemTime& reported = rows.robots_with_open_runs_[record.robot->ruri];
      reported = std::max(reported, record.received_at);
    }
  }
  void operator()(const model::AgentInfo& /*body*/) const { AddLatest(LatestKind::kAgentInfo); }
  void operator()(const model::CurrentSettings& /*body*/) const {
    AddLatest(LatestKind::kSettings);
  }
  void operator()(const model::UiCapabilities& /*body*/) const {
    AddLatest(LatestKind::kUiCapabilities);
  }
  void operator()(const model::ShapeOp& op) const { Present(rows.shapes_, op.upsert()); }
  void operator()(const model::ObjectOp& op) const { Present(rows.objects_, op.upsert()); }
  template <typename Body>
  void operator()(const Body& body) const {
    constexpr std::optional<PageKind> kHistory = HistoryOf<Body>();
    if constexpr (kHistory) {
      rows.added_.Add<List<*kHistory>::kTable>({&record, &body, place});
    } else {
      static_assert(model::SettlingOf<Body>::kSettling == model::Settling::kLive,
                    "a durable kind has a table, or an overload above");
      CheckFailed(__FILE__, __LINE__, "durable", "a live record reached the store");
    }
  }

 private:
  void AddLatest(LatestKind kind) const {
    rows.latest_[{record.robot->ruri, kind}] = {&record, kind};
  }
  /// A removal if there is no upsert.
  template <typename Body>
  void Present(PresentRows<Body>& present, const Body* upsert) const {
    const std::optional<PresentChange> change = PresentChangeOf(record, rows.rules_);
    if (upsert == nullptr) return present.Delete(change->key);
    present.Upsert(record, *upsert, *change, place);
  }
};

void BatchRows::Write(const CommitRecord& record, std::int32_t place) {
  if (const auto* update = std::get_if<model::ScopeUpdate>(&record.content)) {
    added_.Add<kScopeUpdatesTable>({&record, update, place});
  } else if (const auto* request = std::get_if<model::OperatorRequest>(&record.content)) {
    drones_.Add({&record, request, place});
  } else {
    std::visit(KindWriter{*this, record, place}, std::get<model::Record>(record.content).body());
  }
  Raise(record);
}

void BatchRows::Reject(const CommitRecord& record, const model::Rejection& rejection,
                       QuarantineDetail detail, std::int32_t place) {
  added_.Add<kQuarantineTable>({&record, rejection, detail, place});
  if (!record.payload.empty()) robots_with_payloads_.insert(record.robot->ruri);
  Raise(record);
}

void BatchRows::Limit(const CommitRecord& record, const LimitedRange& range, std::int32_t place) {
  limited_.push_back({&record, &range, place});
  Raise(record);
}

void BatchRows::Drop(const PresentKey& key) {
  UPLINK_CHECK(BoundOf(key.kind).expires, "a kind that expires");
  switch (key.kind) {
    case PresentKind::kShape:
      return shapes_.Delete(key);
    case PresentKind::kObject:
      return objects_.Delete(key);
    case PresentKind::kFault:
      break;  // does not expire
  }
}

void BatchRows::AddGap(const GapItem& gap, std::int32_t place) {
  Gap& row = gaps_[{gap.robot->ruri, gap.session, gap.first}];
  // A gap that is reported several times keeps the first one's place.
  if (row.item == nullptr) row = {&gap, 0, place};
  row.last = std::max(row.last, gap.last);
  robots_with_gaps_.insert(gap.robot->ruri);
}

void BatchRows::AddPresence(const PresenceItem& item, const model::SessionId& session,
                            std::int32_t place) {
  const PresenceChange change{&item, place};
  if (item.changes_presence) presence_.push_back(change);
  latest_presence_[item.robot->ruri] = change;
  Raise(kServerRuri, session, item.number, item.at);
}

void BatchRows::Raise(const CommitRecord& record) {
  if (record.sample != nullptr) return;
  Raise(record.robot->ruri, record.session, record.seq, record.received_at);
}

void BatchRows::Raise(std::string_view ruri, const model::SessionId& session, model::Seq seq,
                      SystemTime used) {
  Cursor& cursor = cursors_[{ruri, session}];
  cursor.seq = std::max(cursor.seq, seq);
  cursor.last_used = std::max(cursor.last_used, used);
}

void BatchRows::MoveCursors(std::vector<StoreCall>& calls) const {
  if (cursors_.empty()) return;
  Array ruri{Type::kText}, session{Type::kUuid}, seq{Type::kInt8}, last_used{Type::kTime};
  for (const auto& [key, cursor] : cursors_) {
    ruri.Text(key.first);
    session.Uuid(key.second);
    seq.Int8(cursor.seq);
    last_used.Time(cursor.last_used);
  }
  calls.push_back(StoreCallOf(kRaiseCursors, &ruri, &session, &seq, &last_used));
}

std::vector<StoreCall> BatchRows::TakeCalls() && {
  std::vector<StoreCall> calls;
  added_.MoveInto(calls);
  faults_.MoveInto<kFaultsActiveTable>(calls);
  shapes_.MoveInto<kShapesTable>(calls);
  objects_.MoveInto<kObjectsTable>(calls);
  AddInsert<kMissionRunsTable>(runs_, calls);
  if (!robots_with_open_runs_.empty()) calls.push_back(CloseRunsOver(robots_with_open_runs_));
  AddInsert<kLatestTable>(latest_, calls);
  AddInsert<kPresenceChangesTable>(presence_, calls);
  AddInsert<kLatestPresenceTable>(latest_presence_, calls);
  AddInsert<kGapsTable>(gaps_, calls);
  AddInsert<kKeptRejectsTable>(limited_, calls);
  AddDeliveryCalls(deliveries_, calls);
  drones_.MoveInto(calls);
  MoveCursors(calls);
  if (!robots_with_payloads_.empty()) {
    calls.push_back(
        BoundCall(kThinPayloads, robots_with_payloads_, kQuarantinePayloadsPerRobotMax));
  }
  if (!robots_with_gaps_.empty()) {
    calls.push_back(BoundCall(kTrimGaps, robots_with_gaps_, kGapsPerRobotMax));
  }
  connections_.MoveInto(calls);
  return calls;
}

}  // namespace uplink::storage::postgres
