#include "storage/postgres/present_rows.h"

#include <algorithm>
#include <limits>
#include <type_traits>
#include <utility>

#include "schema/json/text.h"
#include "storage/expiry.h"
#include "storage/numbers.h"

namespace uplink::storage::postgres {
namespace {

/// The row that is there goes whenever it would expire; the statement's own number for it.
constexpr std::int64_t kAlways = std::numeric_limits<std::int64_t>::max();

constexpr std::string_view kClearFaults =
    "DELETE FROM uplinkd.faults_active AS f"
    " USING unnest($1::text[], $2::text[], $3::text[]) AS u (ruri, fault_id, source)"
    " WHERE f.ruri = u.ruri AND f.fault_id = u.fault_id AND f.source = u.source";

constexpr std::string_view kRaiseFaults =
    "INSERT INTO uplinkd.faults_active (ruri, fault_id, source, fleet, raised_at, entry,"
    " received_at, sampled_ms, severity, category, description, suggested_action)"
    " SELECT ruri, fault_id, source, fleet, raised_at,"
    " (SELECT currval('uplinkd.batches') << 20) + place, received_at, sampled_ms, severity,"
    " category, description, suggested_action"
    " FROM unnest($1::text[], $2::text[], $3::text[], $4::text[], $5::timestamptz[], $6::int[],"
    " $7::timestamptz[], $8::bigint[], $9::int[], $10::text[], $11::text[], $12::text[])"
    " AS u (ruri, fault_id, source, fleet, raised_at, place, received_at, sampled_ms, severity,"
    " category, description, suggested_action)"
    " ON CONFLICT (ruri, fault_id, source) DO UPDATE SET fleet = excluded.fleet,"
    " received_at = excluded.received_at, sampled_ms = excluded.sampled_ms,"
    " severity = excluded.severity, category = excluded.category,"
    " description = excluded.description, suggested_action = excluded.suggested_action";

constexpr std::string_view kDeleteShapes =
    "DELETE FROM uplinkd.shapes AS s"
    " USING unnest($1::text[], $2::text[], $3::bigint[]) AS u (ruri, id, by_ms)"
    " WHERE s.ruri = u.ruri AND s.id = u.id AND (u.by_ms = 9223372036854775807"
    " OR (s.expires_ms <> 0 AND s.expires_ms <= u.by_ms))";
constexpr std::string_view kDeleteObjects =
    "DELETE FROM uplinkd.objects AS s"
    " USING unnest($1::text[], $2::text[], $3::bigint[]) AS u (ruri, id, by_ms)"
    " WHERE s.ruri = u.ruri AND s.id = u.id AND (u.by_ms = 9223372036854775807"
    " OR (s.expires_ms <> 0 AND s.expires_ms <= u.by_ms))";

constexpr std::string_view kUpsertShapes =
    "INSERT INTO uplinkd.shapes (ruri, id, fleet, first_at, entry, received_at, expires_ms, name,"
    " rev, hash, area_type, scope, min_z_m, max_z_m, level_id, geometry)"
    " SELECT ruri, id, fleet, first_at, (SELECT currval('uplinkd.batches') << 20) + place,"
    " received_at, expires_ms, name, rev, hash, area_type, scope, min_z_m, max_z_m, level_id,"
    " geometry"
    " FROM unnest($1::text[], $2::text[], $3::text[], $4::timestamptz[], $5::int[],"
    " $6::timestamptz[], $7::bigint[], $8::text[], $9::bigint[], $10::text[], $11::int[],"
    " $12::int[], $13::float8[], $14::float8[], $15::int[], $16::text[])"
    " AS u (ruri, id, fleet, first_at, place, received_at, expires_ms, name, rev, hash, area_type,"
    " scope, min_z_m, max_z_m, level_id, geometry)"
    " ON CONFLICT (ruri, id) DO UPDATE SET fleet = excluded.fleet,"
    " received_at = excluded.received_at, expires_ms = excluded.expires_ms, name = excluded.name,"
    " rev = excluded.rev, hash = excluded.hash, area_type = excluded.area_type,"
    " scope = excluded.scope, min_z_m = excluded.min_z_m, max_z_m = excluded.max_z_m,"
    " level_id = excluded.level_id, geometry = excluded.geometry";

constexpr std::string_view kUpsertObjects =
    "INSERT INTO uplinkd.objects (ruri, id, fleet, first_at, entry, received_at, expires_ms, name,"
    " sampled_ms, object_type, scope, radius_m, location, trajectory)"
    " SELECT ruri, id, fleet, first_at, (SELECT currval('uplinkd.batches') << 20) + place,"
    " received_at, expires_ms, name, sampled_ms, object_type, scope, radius_m, location, trajectory"
    " FROM unnest($1::text[], $2::text[], $3::text[], $4::timestamptz[], $5::int[],"
    " $6::timestamptz[], $7::bigint[], $8::text[], $9::bigint[], $10::int[], $11::int[],"
    " $12::float8[], $13::text[], $14::text[])"
    " AS u (ruri, id, fleet, first_at, place, received_at, expires_ms, name, sampled_ms,"
    " object_type, scope, radius_m, location, trajectory)"
    " ON CONFLICT (ruri, id) DO UPDATE SET fleet = excluded.fleet,"
    " received_at = excluded.received_at, expires_ms = excluded.expires_ms, name = excluded.name,"
    " sampled_ms = excluded.sampled_ms, object_type = excluded.object_type,"
    " scope = excluded.scope, radius_m = excluded.radius_m, location = excluded.location,"
    " trajectory = excluded.trajectory";

}  // namespace

void ActiveFaultRows::Raise(const CommitRecord& record, const model::Fault& fault,
                            std::int32_t place) {
  State& state = states_[KeyOf(record, fault)];
  if (state.record == nullptr) {
    state.raised_at = record.received_at;
    state.place = place;
  }
  state.record = &record;
  state.fault = &fault;
}

void ActiveFaultRows::Clear(const CommitRecord& record, const model::Fault& fault) {
  State& state = states_[KeyOf(record, fault)];
  state.clears = true;
  state.record = nullptr;
}

void ActiveFaultRows::MoveInto(std::vector<Call>& calls) const {
  Array clear_ruri{Type::kText}, clear_id{Type::kText}, clear_source{Type::kText};
  Array ruri{Type::kText}, fault_id{Type::kText}, source{Type::kText}, fleet{Type::kText},
      raised_at{Type::kTime}, place{Type::kInt4}, received_at{Type::kTime}, sampled_ms{Type::kInt8},
      severity{Type::kInt4}, category{Type::kText}, description{Type::kText},
      suggested_action{Type::kText};
  for (const auto& [key, state] : states_) {
    if (state.clears) {
      clear_ruri.Text(std::get<0>(key));
      clear_id.Text(std::get<1>(key));
      clear_source.Text(std::get<2>(key));
    }
    if (state.record == nullptr) continue;
    ruri.Text(std::get<0>(key));
    fault_id.Text(std::get<1>(key));
    source.Text(std::get<2>(key));
    fleet.Text(state.record->robot->fleet);
    raised_at.Time(state.raised_at);
    place.Int4(state.place);
    received_at.Time(state.record->received_at);
    sampled_ms.Int8(state.fault->unix_time_ms);
    severity.Int4(NumberOf(state.fault->severity));
    category.Text(state.fault->category);
    description.Text(state.fault->description);
    suggested_action.Text(state.fault->suggested_action);
  }
  if (clear_ruri.size() > 0) {
    calls.push_back(CallOf(kClearFaults, {&clear_ruri, &clear_id, &clear_source}));
  }
  if (ruri.size() > 0) {
    calls.push_back(
        CallOf(kRaiseFaults, {&ruri, &fault_id, &source, &fleet, &raised_at, &place, &received_at,
                              &sampled_ms, &severity, &category, &description, &suggested_action}));
  }
}

template <typename Body>
void PresentRows<Body>::Upsert(const CommitRecord& record, const Body& body, std::string_view id,
                               std::int64_t expires_ms, std::int32_t place) {
  State& state = states_[{record.robot->ruri, id}];
  const std::int64_t now_ms = UnixMs(record.received_at);
  if (state.record != nullptr && IsExpired(state.expires_ms, now_ms)) {
    state.goes_if_expired_ms = kAlways;
    state.record = nullptr;
  }
  if (state.record == nullptr) {
    state.goes_if_expired_ms = std::max(state.goes_if_expired_ms, now_ms);
    state.first_at = record.received_at;
    state.place = place;
  }
  state.record = &record;
  state.body = &body;
  state.expires_ms = expires_ms;
}

template <typename Body>
void PresentRows<Body>::Delete(std::string_view ruri, std::string_view id) {
  State& state = states_[{ruri, id}];
  state.goes_if_expired_ms = kAlways;
  state.record = nullptr;
}

template <typename Body>
void PresentRows<Body>::MoveInto(std::vector<Call>& calls) const {
  if (states_.empty()) return;
  Array ruri{Type::kText}, id{Type::kText}, by_ms{Type::kInt8};
  bool upserts = false;
  for (const auto& [key, state] : states_) {
    upserts = upserts || state.record != nullptr;
    ruri.Text(key.first);
    id.Text(key.second);
    by_ms.Int8(state.goes_if_expired_ms);
  }
  constexpr bool kIsShape = std::is_same_v<Body, model::ReportedShape>;
  calls.push_back(CallOf(kIsShape ? kDeleteShapes : kDeleteObjects, {&ruri, &id, &by_ms}));
  if (upserts) calls.push_back(UpsertCall(states_));
}

template <>
Call ShapeRows::UpsertCall(const States& states) {
  Array ruri{Type::kText}, id{Type::kText}, fleet{Type::kText}, first_at{Type::kTime},
      place{Type::kInt4}, received_at{Type::kTime}, expires_ms{Type::kInt8}, name{Type::kText},
      rev{Type::kInt8}, hash{Type::kText}, area_type{Type::kInt4}, scope{Type::kInt4},
      min_z_m{Type::kFloat8}, max_z_m{Type::kFloat8}, level_id{Type::kInt4}, geometry{Type::kText};
  for (const auto& [key, state] : states) {
    if (state.record == nullptr) continue;
    ruri.Text(key.first);
    id.Text(key.second);
    fleet.Text(state.record->robot->fleet);
    first_at.Time(state.first_at);
    place.Int4(state.place);
    received_at.Time(state.record->received_at);
    expires_ms.Int8(state.expires_ms);
    name.Text(state.body->identity.name);
    rev.Int8(std::int64_t{state.body->identity.rev});
    hash.Text(state.body->identity.hash);
    area_type.Int4(NumberOf(state.body->area_type));
    scope.Int4(NumberOf(state.body->scope));
    min_z_m.Float8(state.body->min_z_m);
    max_z_m.Float8(state.body->max_z_m);
    level_id.Int4(state.body->level_id);
    geometry.Text(json::GeometryText(state.body->data));
  }
  return CallOf(kUpsertShapes,
                {&ruri, &id, &fleet, &first_at, &place, &received_at, &expires_ms, &name, &rev,
                 &hash, &area_type, &scope, &min_z_m, &max_z_m, &level_id, &geometry});
}

template <>
Call ObjectRows::UpsertCall(const States& states) {
  Array ruri{Type::kText}, id{Type::kText}, fleet{Type::kText}, first_at{Type::kTime},
      place{Type::kInt4}, received_at{Type::kTime}, expires_ms{Type::kInt8}, name{Type::kText},
      sampled_ms{Type::kInt8}, object_type{Type::kInt4}, scope{Type::kInt4},
      radius_m{Type::kFloat8}, location{Type::kText}, trajectory{Type::kText};
  for (const auto& [key, state] : states) {
    if (state.record == nullptr) continue;
    ruri.Text(key.first);
    id.Text(key.second);
    fleet.Text(state.record->robot->fleet);
    first_at.Time(state.first_at);
    place.Int4(state.place);
    received_at.Time(state.record->received_at);
    expires_ms.Int8(state.expires_ms);
    name.Text(state.body->name);
    sampled_ms.Int8(state.body->unix_time_ms);
    object_type.Int4(NumberOf(state.body->object_type));
    scope.Int4(NumberOf(state.body->scope));
    radius_m.Float8(state.body->radius_m);
    location.Text(json::Text(state.body->location));
    if (state.body->trajectory) {
      trajectory.Text(json::Text(*state.body->trajectory));
    } else {
      trajectory.Null();
    }
  }
  return CallOf(kUpsertObjects,
                {&ruri, &id, &fleet, &first_at, &place, &received_at, &expires_ms, &name,
                 &sampled_ms, &object_type, &scope, &radius_m, &location, &trajectory});
}

template class PresentRows<model::ReportedShape>;
template class PresentRows<model::Object>;

}  // namespace uplink::storage::postgres
