#pragma once

#include <string>

#include "schema/json/text.h"
#include "schema/model/spatial.h"
#include "storage/numbers.h"
#include "storage/rows.h"
#include "storage/sqlite/tables/table.h"
#include "storage/sqlite/tables/upserted.h"

// Shapes and objects that are present.
namespace uplink::storage::sqlite {

using UpsertedShape = Upserted<model::ReportedShape>;
using UpsertedObject = Upserted<model::Object>;

// Where the two keep what both have.
inline const std::string& IdOf(const model::ReportedShape& shape) { return shape.identity.id; }
inline const std::string& IdOf(const model::Object& object) { return object.id; }
inline const std::string& NameOf(const model::ReportedShape& shape) { return shape.identity.name; }
inline const std::string& NameOf(const model::Object& object) { return object.name; }
inline std::string& IdOf(ShapeRow& row) { return row.identity.id; }
inline std::string& IdOf(ObjectRow& row) { return row.id; }
inline std::string& NameOf(ShapeRow& row) { return row.identity.name; }
inline std::string& NameOf(ObjectRow& row) { return row.name; }

/// The columns of both. first_at and entry are those of the upsert that made the id present.
template <typename In, typename Out>
inline constexpr std::array<Column<In, Out>, 9> kSpatialColumns = {{
    {"ruri", Role::kKey, [](Binder& to, const In& row) { to.Text(row.record->robot->ruri); }},
    {"id", Role::kKey, [](Binder& to, const In& row) { to.Text(IdOf(*row.body)); },
     [](const Cell& cell, Out& row) { IdOf(row) = cell.Text(); }},
    {"fleet", Role::kValue, [](Binder& to, const In& row) { to.Text(row.record->robot->fleet); }},
    {"first_at", Role::kKept, [](Binder& to, const In& row) { to.Time(row.record->received_at); }},
    {"entry", Role::kKept, [](Binder& to, const In& row) { to.Int(row.entry); }},
    {"received_at", Role::kValue,
     [](Binder& to, const In& row) { to.Time(row.record->received_at); },
     [](const Cell& cell, Out& row) { row.received_at = cell.Time(); }},
    {"expires_ms", Role::kValue, [](Binder& to, const In& row) { to.Int(row.expires_ms); },
     [](const Cell& cell, Out& row) { row.expires_at_ms = cell.Int(); }},
    {"name", Role::kValue, [](Binder& to, const In& row) { to.Text(NameOf(*row.body)); },
     [](const Cell& cell, Out& row) { NameOf(row) = cell.Text(); }},
    {"scope", Role::kValue, [](Binder& to, const In& row) { to.Int(NumberOf(row.body->scope)); },
     [](const Cell& cell, Out& row) { row.scope = MemberOf<model::ScopeType>(cell.Int()); }},
}};

/// Lists stand by the upsert that made the id present, which their rows do not show.
template <typename Out>
constexpr Listed<Out> ByFirstUpsert() {
  return {"first_at", nullptr};
}

inline constexpr Table<UpsertedShape, ShapeRow, 16> kShapesTable = {
    "shapes", Writes::kUpserts, ByFirstUpsert<ShapeRow>(),
    Join(
        kSpatialColumns<UpsertedShape, ShapeRow>,
        std::to_array<Column<UpsertedShape, ShapeRow>>({
            {"rev", Role::kValue,
             [](Binder& to, const UpsertedShape& row) {
               to.Int(std::int64_t{row.body->identity.rev});
             },
             [](const Cell& cell, ShapeRow& row) {
               row.identity.rev = static_cast<std::uint32_t>(cell.Int());
             }},
            {"hash", Role::kValue,
             [](Binder& to, const UpsertedShape& row) { to.Text(row.body->identity.hash); },
             [](const Cell& cell, ShapeRow& row) { row.identity.hash = cell.Text(); }},
            {"area_type", Role::kValue,
             [](Binder& to, const UpsertedShape& row) { to.Int(NumberOf(row.body->area_type)); },
             [](const Cell& cell, ShapeRow& row) {
               row.area_type = MemberOf<model::ReportedLayerRole>(cell.Int());
             }},
            {"min_z_m", Role::kValue,
             [](Binder& to, const UpsertedShape& row) { to.Real(row.body->min_z_m); },
             [](const Cell& cell, ShapeRow& row) { row.min_z_m = cell.Real(); }},
            {"max_z_m", Role::kValue,
             [](Binder& to, const UpsertedShape& row) { to.Real(row.body->max_z_m); },
             [](const Cell& cell, ShapeRow& row) { row.max_z_m = cell.Real(); }},
            {"level_id", Role::kValue,
             [](Binder& to, const UpsertedShape& row) { to.Int(std::int64_t{row.body->level_id}); },
             [](const Cell& cell, ShapeRow& row) {
               row.level_id = static_cast<std::int32_t>(cell.Int());
             }},
            {"geometry", Role::kValue,
             [](Binder& to, const UpsertedShape& row) {
               to.Made(json::GeometryText(row.body->data));
             },
             [](const Cell& cell, ShapeRow& row) { row.geometry_json = cell.Text(); }},
        }))};

inline constexpr Table<UpsertedObject, ObjectRow, 14> kObjectsTable = {
    "objects", Writes::kUpserts, ByFirstUpsert<ObjectRow>(),
    Join(
        kSpatialColumns<UpsertedObject, ObjectRow>,
        std::to_array<Column<UpsertedObject, ObjectRow>>({
            {"sampled_ms", Role::kValue,
             [](Binder& to, const UpsertedObject& row) { to.Int(row.body->unix_time_ms); },
             [](const Cell& cell, ObjectRow& row) { row.sampled_at_ms = cell.Int(); }},
            {"object_type", Role::kValue,
             [](Binder& to, const UpsertedObject& row) { to.Int(NumberOf(row.body->object_type)); },
             [](const Cell& cell, ObjectRow& row) {
               row.object_type = MemberOf<model::ObjectType>(cell.Int());
             }},
            {"radius_m", Role::kValue,
             [](Binder& to, const UpsertedObject& row) { to.Real(row.body->radius_m); },
             [](const Cell& cell, ObjectRow& row) { row.radius_m = cell.Real(); }},
            {"location", Role::kValue,
             [](Binder& to, const UpsertedObject& row) { to.Made(json::Text(row.body->location)); },
             [](const Cell& cell, ObjectRow& row) { row.location_json = cell.Text(); }},
            {"trajectory", Role::kValue,
             [](Binder& to, const UpsertedObject& row) {
               if (row.body->trajectory) {
                 to.Made(json::Text(*row.body->trajectory));
               } else {
                 to.Null();
               }
             },
             [](const Cell& cell, ObjectRow& row) { row.trajectory_json = cell.Text(); }},
        }))};

}  // namespace uplink::storage::sqlite
