#pragma once

#include "schema/json/text.h"
#include "schema/model/spatial.h"
#include "storage/numbers.h"
#include "storage/postgres/tables/report_columns.h"
#include "storage/postgres/tables/upserted.h"
#include "storage/reader.h"

// Shapes and objects that are present.
namespace uplink::storage::postgres {

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
    {"ruri", Type::kText, Role::kKey,
     [](Array& to, const In& row) { to.Text(row.record->robot->ruri); }},
    {"id", Type::kText, Role::kKey, [](Array& to, const In& row) { to.Text(IdOf(*row.body)); },
     [](const Cell& cell, Out& row) { IdOf(row) = cell.Text(); }},
    {"fleet", Type::kText, Role::kValue,
     [](Array& to, const In& row) { to.Text(row.record->robot->fleet); }},
    {"first_at", Type::kTime, Role::kKept, [](Array& to, const In& row) { to.Time(row.first_at); }},
    {"entry", Type::kInt4, Role::kKept, [](Array& to, const In& row) { to.Int4(row.place); },
     std::nullopt, kEntryOfPlace},
    {"received_at", Type::kTime, Role::kValue,
     [](Array& to, const In& row) { to.Time(row.record->received_at); },
     [](const Cell& cell, Out& row) { row.received_at = cell.Time(); }},
    {"expires_ms", Type::kInt8, Role::kValue,
     [](Array& to, const In& row) { to.Int8(row.expires_ms); },
     [](const Cell& cell, Out& row) { row.expires_at_ms = cell.Int(); }},
    {"name", Type::kText, Role::kValue,
     [](Array& to, const In& row) { to.Text(NameOf(*row.body)); },
     [](const Cell& cell, Out& row) { NameOf(row) = cell.Text(); }},
    {"scope", Type::kInt4, Role::kValue,
     [](Array& to, const In& row) { to.Int4(NumberOf(row.body->scope)); },
     [](const Cell& cell, Out& row) { row.scope = MemberOf<model::ScopeType>(cell.Int()); }},
}};

/// Lists stand by the upsert that made the id present, which their rows do not show.
template <typename Out>
constexpr Listed<Out> ByFirstUpsert() {
  return {"first_at", nullptr};
}

inline constexpr Table<UpsertedShape, ShapeRow, 16> kShapesTable = {
    "shapes", Writes::kUpserts, ByFirstUpsert<ShapeRow>(),
    Join(kSpatialColumns<UpsertedShape, ShapeRow>,
         std::to_array<Column<UpsertedShape, ShapeRow>>({
             {"rev", Type::kInt8, Role::kValue,
              [](Array& to, const UpsertedShape& row) {
                to.Int8(std::int64_t{row.body->identity.rev});
              },
              [](const Cell& cell, ShapeRow& row) {
                row.identity.rev = static_cast<std::uint32_t>(cell.Int());
              }},
             {"hash", Type::kText, Role::kValue,
              [](Array& to, const UpsertedShape& row) { to.Text(row.body->identity.hash); },
              [](const Cell& cell, ShapeRow& row) { row.identity.hash = cell.Text(); }},
             {"area_type", Type::kInt4, Role::kValue,
              [](Array& to, const UpsertedShape& row) { to.Int4(NumberOf(row.body->area_type)); },
              [](const Cell& cell, ShapeRow& row) {
                row.area_type = MemberOf<model::ReportedLayerRole>(cell.Int());
              }},
             {"min_z_m", Type::kFloat8, Role::kValue,
              [](Array& to, const UpsertedShape& row) { to.Float8(row.body->min_z_m); },
              [](const Cell& cell, ShapeRow& row) { row.min_z_m = cell.Real(); }},
             {"max_z_m", Type::kFloat8, Role::kValue,
              [](Array& to, const UpsertedShape& row) { to.Float8(row.body->max_z_m); },
              [](const Cell& cell, ShapeRow& row) { row.max_z_m = cell.Real(); }},
             {"level_id", Type::kInt4, Role::kValue,
              [](Array& to, const UpsertedShape& row) { to.Int4(row.body->level_id); },
              [](const Cell& cell, ShapeRow& row) {
                row.level_id = static_cast<std::int32_t>(cell.Int());
              }},
             {"geometry", Type::kText, Role::kValue,
              [](Array& to, const UpsertedShape& row) {
                to.Text(json::GeometryText(row.body->data));
              },
              [](const Cell& cell, ShapeRow& row) { row.geometry_json = cell.Text(); }},
         }))};

inline constexpr Table<UpsertedObject, ObjectRow, 14> kObjectsTable = {
    "objects", Writes::kUpserts, ByFirstUpsert<ObjectRow>(),
    Join(
        kSpatialColumns<UpsertedObject, ObjectRow>,
        std::to_array<Column<UpsertedObject, ObjectRow>>({
            {"sampled_ms", Type::kInt8, Role::kValue,
             [](Array& to, const UpsertedObject& row) { to.Int8(row.body->unix_time_ms); },
             [](const Cell& cell, ObjectRow& row) { row.sampled_at_ms = cell.Int(); }},
            {"object_type", Type::kInt4, Role::kValue,
             [](Array& to, const UpsertedObject& row) { to.Int4(NumberOf(row.body->object_type)); },
             [](const Cell& cell, ObjectRow& row) {
               row.object_type = MemberOf<model::ObjectType>(cell.Int());
             }},
            {"radius_m", Type::kFloat8, Role::kValue,
             [](Array& to, const UpsertedObject& row) { to.Float8(row.body->radius_m); },
             [](const Cell& cell, ObjectRow& row) { row.radius_m = cell.Real(); }},
            {"location", Type::kText, Role::kValue,
             [](Array& to, const UpsertedObject& row) { to.Text(json::Text(row.body->location)); },
             [](const Cell& cell, ObjectRow& row) { row.location_json = cell.Text(); }},
            {"trajectory", Type::kText, Role::kValue,
             [](Array& to, const UpsertedObject& row) {
               if (row.body->trajectory) {
                 to.Text(json::Text(*row.body->trajectory));
               } else {
                 to.Null();
               }
             },
             [](const Cell& cell, ObjectRow& row) { row.trajectory_json = cell.Text(); }},
        }))};

}  // namespace uplink::storage::postgres
