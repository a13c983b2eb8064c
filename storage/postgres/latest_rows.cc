#include "storage/postgres/latest_rows.h"

#include <algorithm>
#include <variant>

#include "schema/base/check.h"
#include "schema/json/text.h"
#include "storage/numbers.h"
#include "storage/postgres/parameters.h"

namespace uplink::storage::postgres {
namespace {

// $13: whether the names count; a report without one leaves the name that is there.
constexpr std::string_view kUpsertRuns =
    "INSERT INTO uplinkd.mission_runs AS r (ruri, mission_id, run_id, fleet, first_at, entry,"
    " last_at, name, status, is_open, updates, latest)"
    " SELECT ruri, mission_id, run_id, fleet, first_at,"
    " (SELECT currval('uplinkd.batches') << 20) + place, last_at, name, status, is_open, updates,"
    " latest"
    " FROM unnest($1::text[], $2::text[], $3::text[], $4::text[], $5::timestamptz[], $6::int[],"
    " $7::timestamptz[], $8::text[], $9::int[], $10::bool[], $11::bigint[], $12::text[])"
    " AS u (ruri, mission_id, run_id, fleet, first_at, place, last_at, name, status, is_open,"
    " updates, latest)"
    " ON CONFLICT (ruri, mission_id, run_id) DO UPDATE SET fleet = excluded.fleet,"
    " last_at = excluded.last_at,"
    " name = CASE WHEN $13::int = 1 THEN excluded.name ELSE r.name END, status = excluded.status,"
    " is_open = excluded.is_open, updates = r.updates + excluded.updates, latest = excluded.latest";

constexpr std::string_view kUpsertLatest =
    "INSERT INTO uplinkd.latest (ruri, kind, fleet, received_at, body)"
    " SELECT * FROM unnest($1::text[], $2::int[], $3::text[], $4::timestamptz[], $5::text[])"
    " ON CONFLICT (ruri, kind) DO UPDATE SET fleet = excluded.fleet,"
    " received_at = excluded.received_at, body = excluded.body";

constexpr std::string_view kInsertPresence =
    "INSERT INTO uplinkd.presence_changes (ruri, changed_at, entry, fleet, presence)"
    " SELECT ruri, changed_at, (SELECT currval('uplinkd.batches') << 20) + place, fleet, presence"
    " FROM unnest($1::text[], $2::timestamptz[], $3::int[], $4::text[], $5::int[])"
    " AS u (ruri, changed_at, place, fleet, presence)";
constexpr std::string_view kUpsertPresence =
    "INSERT INTO uplinkd.presence_latest AS l (ruri, presence, changed_at)"
    " SELECT * FROM unnest($1::text[], $2::int[], $3::timestamptz[])"
    " ON CONFLICT (ruri) DO UPDATE SET presence = excluded.presence,"
    " changed_at = excluded.changed_at WHERE l.changed_at <= excluded.changed_at";

constexpr std::string_view kUpsertGaps =
    "INSERT INTO uplinkd.gaps AS g (ruri, session, first, last, fleet, seen_at, entry)"
    " SELECT ruri, session, first, last, fleet, seen_at,"
    " (SELECT currval('uplinkd.batches') << 20) + place"
    " FROM unnest($1::text[], $2::uuid[], $3::bigint[], $4::bigint[], $5::text[],"
    " $6::timestamptz[], $7::int[]) AS u (ruri, session, first, last, fleet, seen_at, place)"
    " ON CONFLICT (ruri, session, first) DO UPDATE SET last = greatest(g.last, excluded.last)";

std::string BodyText(const CommitRecord& record) {
  const model::Body& body = std::get<model::Record>(record.content).body();
  if (const auto* info = std::get_if<model::AgentInfo>(&body)) return json::Text(*info);
  if (const auto* settings = std::get_if<model::CurrentSettings>(&body)) {
    return json::Text(*settings);
  }
  const auto* capabilities = std::get_if<model::UiCapabilities>(&body);
  UPLINK_CHECK(capabilities != nullptr, "a kind of which the latest is kept");
  return json::Text(*capabilities);
}

}  // namespace

void MissionRunRows::Add(const CommitRecord& record, const model::MissionRunStatus& report,
                         std::string report_json, std::int32_t place) {
  Run& run = runs_[{record.robot->ruri, report.mission_id, report.run_id}];
  if (run.last == nullptr) {
    run.first_at = record.received_at;
    run.place = place;
  }
  run.last = &record;
  run.status = report.status;
  run.latest_json = std::move(report_json);
  if (report.name) run.name = &*report.name;
  ++run.updates;
}

void MissionRunRows::MoveInto(std::vector<Call>& calls) const {
  MoveSome(true, calls);
  MoveSome(false, calls);
}

void MissionRunRows::MoveSome(bool named, std::vector<Call>& calls) const {
  Array ruri{Type::kText}, mission_id{Type::kText}, run_id{Type::kText}, fleet{Type::kText},
      first_at{Type::kTime}, place{Type::kInt4}, last_at{Type::kTime}, name{Type::kText},
      status{Type::kInt4}, is_open{Type::kBool}, updates{Type::kInt8}, latest{Type::kText};
  for (const auto& [key, run] : runs_) {
    if ((run.name != nullptr) != named) continue;
    ruri.Text(std::get<0>(key));
    mission_id.Text(std::get<1>(key));
    run_id.Text(std::get<2>(key));
    fleet.Text(run.last->robot->fleet);
    first_at.Time(run.first_at);
    place.Int4(run.place);
    last_at.Time(run.last->received_at);
    name.Text(named ? std::string_view(*run.name) : std::string_view());
    status.Int4(NumberOf(run.status));
    is_open.Bool(!model::IsTerminal(run.status));
    updates.Int8(run.updates);
    latest.Text(run.latest_json);
  }
  if (ruri.size() == 0) return;
  calls.push_back(CallOf(kUpsertRuns, {&ruri, &mission_id, &run_id, &fleet, &first_at, &place,
                                       &last_at, &name, &status, &is_open, &updates, &latest}));
  calls.back().parameters.Int4(named ? 1 : 0);
}

void LatestRows::MoveInto(std::vector<Call>& calls) const {
  if (last_.empty()) return;
  Array ruri{Type::kText}, kind{Type::kInt4}, fleet{Type::kText}, received_at{Type::kTime},
      body{Type::kText};
  for (const auto& [key, record] : last_) {
    ruri.Text(key.first);
    kind.Int4(static_cast<std::int32_t>(key.second));
    fleet.Text(record->robot->fleet);
    received_at.Time(record->received_at);
    body.Text(BodyText(*record));
  }
  calls.push_back(CallOf(kUpsertLatest, {&ruri, &kind, &fleet, &received_at, &body}));
}

void PresenceRows::MoveInto(std::vector<Call>& calls) const {
  if (items_.empty()) return;
  Array ruri{Type::kText}, changed_at{Type::kTime}, place{Type::kInt4}, fleet{Type::kText},
      presence{Type::kInt4};
  std::map<std::string_view, const PresenceItem*> last;
  for (const auto& [item, at] : items_) {
    ruri.Text(item->robot->ruri);
    changed_at.Time(item->at);
    place.Int4(at);
    fleet.Text(item->robot->fleet);
    presence.Int4(static_cast<std::int32_t>(item->presence));
    const PresenceItem*& latest = last[item->robot->ruri];
    if (latest == nullptr || latest->at <= item->at) latest = item;
  }
  calls.push_back(CallOf(kInsertPresence, {&ruri, &changed_at, &place, &fleet, &presence}));
  Array last_ruri{Type::kText}, last_presence{Type::kInt4}, last_at{Type::kTime};
  for (const auto& [name, item] : last) {
    last_ruri.Text(name);
    last_presence.Int4(static_cast<std::int32_t>(item->presence));
    last_at.Time(item->at);
  }
  calls.push_back(CallOf(kUpsertPresence, {&last_ruri, &last_presence, &last_at}));
}

void GapRows::Add(const GapItem& gap, std::int32_t place) {
  Gap& row = gaps_[{gap.robot->ruri, gap.session, gap.first}];
  if (row.first == nullptr) {
    row.first = &gap;
    row.place = place;
  }
  row.last = std::max(row.last, gap.last);
}

void GapRows::MoveInto(std::vector<Call>& calls) const {
  if (gaps_.empty()) return;
  Array ruri{Type::kText}, session{Type::kUuid}, first{Type::kInt8}, last{Type::kInt8},
      fleet{Type::kText}, seen_at{Type::kTime}, place{Type::kInt4};
  for (const auto& [key, gap] : gaps_) {
    ruri.Text(std::get<0>(key));
    session.Uuid(std::get<1>(key));
    first.Int8(std::get<2>(key));
    last.Int8(gap.last);
    fleet.Text(gap.first->robot->fleet);
    seen_at.Time(gap.first->seen_at);
    place.Int4(gap.place);
  }
  calls.push_back(CallOf(kUpsertGaps, {&ruri, &session, &first, &last, &fleet, &seen_at, &place}));
}

}  // namespace uplink::storage::postgres
